#include "phasescan/slam/place_index.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "slam/place_index.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace phasescan {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Squared distances of the query to each of `count` descriptors of `size` numbers, a multiple of 32.
void Distances(const std::int8_t* HWY_RESTRICT query, const std::int8_t* HWY_RESTRICT all, std::size_t count,
               std::size_t size, std::uint32_t* HWY_RESTRICT out) {
  const hn::CappedTag<std::int16_t, 32> d16;
  const hn::Rebind<std::int8_t, decltype(d16)> d8;
  const hn::RepartitionToWide<decltype(d16)> d32;
  for (std::size_t k = 0; k < count; ++k, all += size) {
    auto even = hn::Zero(d32), odd = hn::Zero(d32);
    for (std::size_t i = 0; i < size; i += hn::Lanes(d16)) {
      const auto step =
          hn::Sub(hn::PromoteTo(d16, hn::LoadU(d8, query + i)), hn::PromoteTo(d16, hn::LoadU(d8, all + i)));
      even = hn::ReorderWidenMulAccumulate(d32, step, step, even, odd);
    }
    out[k] = static_cast<std::uint32_t>(hn::GetLane(hn::SumOfLanes(d32, hn::Add(even, odd))));
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
