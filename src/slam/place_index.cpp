#include "phasescan/slam/place_index.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "slam/place_index.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace phasescan {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Inner products of the query with each of `count` rows of `size` numbers, a multiple of 32.
void InnerProducts(const std::int16_t* HWY_RESTRICT query, const std::int8_t* HWY_RESTRICT rows, std::size_t count,
                   std::size_t size, std::int32_t* HWY_RESTRICT out) {
  const hn::CappedTag<std::int16_t, 32> d16;
  const hn::Rebind<std::int8_t, decltype(d16)> d8;
  const hn::RepartitionToWide<decltype(d16)> d32;
  for (std::size_t k = 0; k < count; ++k, rows += size) {
    auto even = hn::Zero(d32), odd = hn::Zero(d32);
    for (std::size_t i = 0; i < size; i += hn::Lanes(d16)) {
      const auto row = hn::PromoteTo(d16, hn::LoadU(d8, rows + i));
      even = hn::ReorderWidenMulAccumulate(d32, hn::LoadU(d16, query + i), row, even, odd);
    }
    out[k] = hn::GetLane(hn::SumOfLanes(d32, hn::Add(even, odd)));
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace phasescan
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <algorithm>
#include <array>

namespace phasescan {
HWY_EXPORT(InnerProducts);

namespace {

constexpr std::size_t kBlock = 512;  // distances worked out before they are looked at

std::int32_t squares(const PlaceDescriptor& d) {
  std::int32_t sum = 0;
  for (const std::int8_t v : d) sum += v * v;
  return sum;
}

}  // namespace

std::uint32_t PlaceIndex::add(const PlaceDescriptor& descriptor) {
  descriptors_.insert(descriptors_.end(), descriptor.begin(), descriptor.end());
  squares_.push_back(squares(descriptor));
  return static_cast<std::uint32_t>(size() - 1);
}

std::vector<PlaceHit> PlaceIndex::nearest(const PlaceDescriptor& query, std::size_t count, std::size_t limit) const {
  const std::size_t n = limit == 0 ? size() : std::min(limit, size());
  std::vector<PlaceHit> best;
  if (count == 0) return best;
  best.reserve(count + 1);
  std::array<std::int16_t, kDescriptorSize> wide;
  std::copy(query.begin(), query.end(), wide.begin());
  const std::int32_t query_squares = squares(query);
  std::array<std::int32_t, kBlock> products;
  for (std::size_t from = 0; from < n; from += kBlock) {
    const std::size_t block = std::min(kBlock, n - from);
    HWY_DYNAMIC_DISPATCH(InnerProducts)
    (wide.data(), descriptors_.data() + from * kDescriptorSize, block, kDescriptorSize, products.data());
    for (std::size_t k = 0; k < block; ++k) {
      const auto distance = static_cast<std::uint32_t>(query_squares + squares_[from + k] - 2 * products[k]);
      if (best.size() == count && distance >= best.back().distance) continue;
      const PlaceHit hit{static_cast<std::uint32_t>(from + k), distance};
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
