#include "localize/view_kernel.hpp"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "localize/view_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace phasescan {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

// Without vectors there are neither sums of eight bytes nor halves of a vector.
void CompareAtCoarseTurns(const std::uint8_t* view, std::uint8_t reach, const std::uint8_t* rotated,
                          const std::uint8_t* most, std::uint16_t* cost) {
  std::fill(cost, cost + kCoarseTurns, std::uint16_t{0});
  for (std::size_t c = 0; c < kCoarseDirections; ++c) {
    const int a = std::min(view[c], reach);
    for (std::size_t t = 0; t < kCoarseTurns; ++t) {
      const int off = std::abs(a - rotated[c * kCoarseTurns + t]);
      cost[t] = static_cast<std::uint16_t>(cost[t] + std::min<int>(off, most[c * kCoarseTurns + t]));
    }
  }
}

std::uint16_t CompareAtTurn(const std::uint8_t* view, std::uint8_t reach, const std::uint8_t* rotated,
                            const std::uint8_t* most) {
  int sum = 0;
  for (std::size_t d = 0; d < kViewDirections; ++d)
    sum += std::min<int>(std::abs(std::min(view[d], reach) - rotated[d]), most[d]);
  return static_cast<std::uint16_t>(sum);
}

#else

// Lanes are turns: a byte of the view meets the scan at many turns at once, and nothing is summed across lanes.
void CompareAtCoarseTurns(const std::uint8_t* HWY_RESTRICT view, std::uint8_t reach,
                          const std::uint8_t* HWY_RESTRICT rotated, const std::uint8_t* HWY_RESTRICT most,
                          std::uint16_t* HWY_RESTRICT cost) {
  constexpr std::size_t kInBytes = 255 / kMostDifference;  // so many differences add up within a byte
  const hn::CappedTag<std::uint8_t, kCoarseTurns> d8;
  const hn::Repartition<std::uint16_t, decltype(d8)> d16;
  const hn::Half<decltype(d8)> half8;
  const std::size_t lanes = hn::Lanes(d8);
  for (std::size_t t = 0; t < kCoarseTurns; t += lanes) {
    auto low = hn::Zero(d16), high = hn::Zero(d16);
    for (std::size_t c = 0; c < kCoarseDirections;) {
      auto sum = hn::Zero(d8);
      const std::size_t end = std::min(c + kInBytes, kCoarseDirections);
      for (; c < end; ++c) {
        const auto a = hn::Set(d8, std::min(view[c], reach));
        const auto b = hn::LoadU(d8, rotated + c * kCoarseTurns + t);
        const auto off = hn::Or(hn::SaturatedSub(a, b), hn::SaturatedSub(b, a));
        sum = hn::Add(sum, hn::Min(off, hn::LoadU(d8, most + c * kCoarseTurns + t)));
      }
      low = hn::Add(low, hn::PromoteTo(d16, hn::LowerHalf(half8, sum)));
      high = hn::Add(high, hn::PromoteTo(d16, hn::UpperHalf(half8, sum)));
    }
    hn::StoreU(low, d16, cost + t);
    hn::StoreU(high, d16, cost + t + lanes / 2);
  }
}

std::uint16_t CompareAtTurn(const std::uint8_t* HWY_RESTRICT view, std::uint8_t reach,
                            const std::uint8_t* HWY_RESTRICT rotated, const std::uint8_t* HWY_RESTRICT most) {
  const hn::CappedTag<std::uint8_t, kViewDirections> d8;
  const hn::Repartition<std::uint64_t, decltype(d8)> d64;
  const std::size_t lanes = hn::Lanes(d8);
  const auto furthest = hn::Set(d8, reach);
  auto sums = hn::Zero(d64);
  for (std::size_t d = 0; d < kViewDirections; d += lanes) {
    const auto a = hn::Min(hn::LoadU(d8, view + d), furthest), b = hn::LoadU(d8, rotated + d);
    const auto off = hn::Or(hn::SaturatedSub(a, b), hn::SaturatedSub(b, a));
    sums = hn::Add(sums, hn::SumsOf8(hn::Min(off, hn::LoadU(d8, most + d))));
  }
  return static_cast<std::uint16_t>(hn::GetLane(hn::SumOfLanes(d64, sums)));
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace phasescan
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace phasescan {
HWY_EXPORT(CompareAtCoarseTurns);
HWY_EXPORT(CompareAtTurn);

std::uint16_t compare_at_coarse_turns(const std::uint8_t* view, std::uint8_t reach, const std::uint8_t* rotated,
                                      const std::uint8_t* most, std::uint16_t* cost) {
  HWY_DYNAMIC_DISPATCH(CompareAtCoarseTurns)(view, reach, rotated, most, cost);
  std::uint16_t least = cost[0];
  for (std::size_t t = 1; t < kCoarseTurns; ++t) least = std::min(least, cost[t]);
  return least;
}

std::uint16_t compare_at_turn(const std::uint8_t* view, std::uint8_t reach, const std::uint8_t* rotated,
                              const std::uint8_t* most) {
  return HWY_DYNAMIC_DISPATCH(CompareAtTurn)(view, reach, rotated, most);
}

}  // namespace phasescan
#endif
