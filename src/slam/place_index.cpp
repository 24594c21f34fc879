#include "phasescan/slam/place_index.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "slam/place_index.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace phasescan {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Sum of absolute differences of the query to each of `count` descriptors of `size` bytes, a multiple of 64.
void Distances(const std::uint8_t* HWY_RESTRICT query, const std::uint8_t* HWY_RESTRICT all, std::size_t count,
               std::size_t size, std::uint32_t* HWY_RESTRICT out) {
  const hn::CappedTag<std::uint8_t, 64> d;
  const hn::Repartition<std::uint64_t, decltype(d)> d64;
  for (std::size_t k = 0; k < count; ++k, all += size) {
    auto sum = hn::Zero(d64);
    for (std::size_t i = 0; i < size; i += hn::Lanes(d)) {
      const auto a = hn::LoadU(d, query + i), b = hn::LoadU(d, all + i);
      sum = hn::Add(sum, hn::SumsOf8(hn::Or(hn::SaturatedSub(a, b), hn::SaturatedSub(b, a))));
    }
    out[k] = static_cast<std::uint32_t>(hn::GetLane(hn::SumOfLanes(d64, sum)));
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace phasescan
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <algorithm>
#include <array>

namespace phasescan {
HWY_EXPORT(Distances);

namespace {
constexpr std::size_t kBlock = 512;  // distances worked out before they are looked at
}

std::uint32_t PlaceIndex::add(const PlaceDescriptor& descriptor) {
  descriptors_.insert(descriptors_.end(), descriptor.begin(), descriptor.end());
  return static_cast<std::uint32_t>(size() - 1);
}

std::vector<PlaceHit> PlaceIndex::nearest(const PlaceDescriptor& query, std::size_t count, std::size_t limit) const {
  const std::size_t n = limit == 0 ? size() : std::min(limit, size());
  std::vector<PlaceHit> best;
  if (count == 0) return best;
  best.reserve(count + 1);
  std::array<std::uint32_t, kBlock> distances;
  for (std::size_t from = 0; from < n; from += kBlock) {
    const std::size_t block = std::min(kBlock, n - from);
    HWY_DYNAMIC_DISPATCH(Distances)
    (query.data(), descriptors_.data() + from * kDescriptorSize, block, kDescriptorSize, distances.data());
    for (std::size_t k = 0; k < block; ++k) {
      if (best.size() == count && distances[k] >= best.back().distance) continue;
      const PlaceHit hit{static_cast<std::uint32_t>(from + k), distances[k]};
      best.insert(std::upper_bound(best.begin(), best.end(), hit,
                                   [](const PlaceHit& a, const PlaceHit& b) { return a.distance < b.distance; }),
                  hit);
      if (best.size() > count) best.pop_back();
    }
  }
  return best;
}

}  // namespace phasescan
#endif
