#include "localize/view_kernel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "localize/view_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace phasescan {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

// Without vectors there are no sums of eight bytes.
void CompareAtAllTurns(const std::uint8_t* HWY_RESTRICT view, std::uint8_t reach,
                       const std::uint8_t* HWY_RESTRICT rotated, const std::uint8_t* HWY_RESTRICT known,
                       std::size_t turns, std::uint16_t* HWY_RESTRICT cost) {
  for (std::size_t t = 0; t < turns; ++t) {
    unsigned sum = 0;
    for (std::size_t d = 0; d < kViewHalf; ++d) {
      const std::uint8_t a = view[d] < reach ? view[d] : reach, b = rotated[t * kViewHalf + d];
      const std::uint8_t off = a > b ? a - b : b - a;
      sum += (off < kMostDifference ? off : kMostDifference) & known[t * kViewHalf + d];
    }
    cost[t] = static_cast<std::uint16_t>(sum);
  }
}

#else

void CompareAtAllTurns(const std::uint8_t* HWY_RESTRICT view, std::uint8_t reach,
                       const std::uint8_t* HWY_RESTRICT rotated, const std::uint8_t* HWY_RESTRICT known,
                       std::size_t turns, std::uint16_t* HWY_RESTRICT cost) {
  const hn::CappedTag<std::uint8_t, kViewHalf> d8;
  const hn::Repartition<std::uint64_t, decltype(d8)> d64;
  const std::size_t lanes = hn::Lanes(d8);
  const auto most = hn::Set(d8, kMostDifference), furthest = hn::Set(d8, reach);
  for (std::size_t t = 0; t < turns; ++t) {
    auto sums = hn::Zero(d64);
    for (std::size_t d = 0; d < kViewHalf; d += lanes) {
      const auto a = hn::Min(hn::LoadU(d8, view + d), furthest);
      const auto b = hn::LoadU(d8, rotated + t * kViewHalf + d);
      const auto off = hn::Or(hn::SaturatedSub(a, b), hn::SaturatedSub(b, a));
      sums = hn::Add(sums, hn::SumsOf8(hn::And(hn::Min(off, most), hn::LoadU(d8, known + t * kViewHalf + d))));
    }
    cost[t] = static_cast<std::uint16_t>(hn::GetLane(hn::SumOfLanes(d64, sums)));
  }
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace phasescan
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace phasescan {
HWY_EXPORT(CompareAtAllTurns);

void compare_at_all_turns(const std::uint8_t* view, std::uint8_t reach, const std::uint8_t* rotated,
                          const std::uint8_t* known, std::size_t turns, std::uint16_t* cost) {
  HWY_DYNAMIC_DISPATCH(CompareAtAllTurns)(view, reach, rotated, known, turns, cost);
}

}  // namespace phasescan
#endif
