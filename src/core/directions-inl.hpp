// direction_turns of core/fast_math.hpp for vectors, bit by bit the same; for inclusion into the per-target part of
// vector code.
#if defined(PHASESCAN_CORE_DIRECTIONS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PHASESCAN_CORE_DIRECTIONS_INL
#undef PHASESCAN_CORE_DIRECTIONS_INL
#else
#define PHASESCAN_CORE_DIRECTIONS_INL
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace phasescan {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class DF, class V = hn::Vec<DF>>
HWY_INLINE V DirectionTurns(DF df, V x, V y) {
  const V ax = hn::Abs(x), ay = hn::Abs(y), zero = hn::Zero(df), one = hn::Set(df, 1.0F);
  const V big = hn::Max(ax, ay), small = hn::Min(ax, ay);
  const V t = hn::Div(small, hn::Max(big, hn::Set(df, 1e-20F)));
  const V s = hn::Mul(t, t);
  V p = hn::Add(hn::Set(df, -0.0135493F), hn::Mul(s, hn::Set(df, 0.0033160F)));
  p = hn::Add(hn::Set(df, 0.0286703F), hn::Mul(s, p));
  p = hn::Add(hn::Set(df, -0.0525688F), hn::Mul(s, p));
  V turns = hn::Mul(t, hn::Add(hn::Set(df, 0.1591336F), hn::Mul(s, p)));
  turns = hn::IfThenElse(hn::Gt(ay, ax), hn::Sub(hn::Set(df, 0.25F), turns), turns);
  turns = hn::IfThenElse(hn::Lt(x, zero), hn::Sub(hn::Set(df, 0.5F), turns), turns);
  turns = hn::IfThenElse(hn::Lt(y, zero), hn::Sub(one, turns), turns);
  return hn::IfThenElse(hn::Ge(turns, one), zero, turns);
}

}  // namespace HWY_NAMESPACE
}  // namespace phasescan
HWY_AFTER_NAMESPACE();

#endif
