// Nearest surface point for a vector of positions; for inclusion into the per-target part of vector code.
#if defined(PHASESCAN_REFINE_NEAREST_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PHASESCAN_REFINE_NEAREST_INL
#undef PHASESCAN_REFINE_NEAREST_INL
#else
#define PHASESCAN_REFINE_NEAREST_INL
#endif

#include <hwy/highway.h>

#include "refine/nearest_grid.hpp"

HWY_BEFORE_NAMESPACE();
namespace phasescan {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Floats per SurfacePoint and where each stands.
constexpr int kPointFloats = sizeof(SurfacePoint) / sizeof(float);
enum PointField { kX = 0, kY = 1, kLineX = 2, kLineY = 3, kNx = 4, kNy = 5, kLength = 6, kVariance = 7 };
static_assert(sizeof(SurfacePoint) == 8 * sizeof(float));

template <class DF, class VI>
HWY_INLINE hn::Vec<DF> GatherField(DF df, const float* points, VI index, int field) {
  const hn::RebindToSigned<DF> di;
  return hn::GatherIndex(df, points, hn::Add(hn::ShiftLeft<3>(index), hn::Set(di, field)));
}

// The nearer of points `at` and what was best so far.
template <class DF, class VF = hn::Vec<DF>, class VI = hn::Vec<hn::RebindToSigned<DF>>>
HWY_INLINE void TakeNearer(DF df, const float* points, VI at, VF qx, VF qy, VI& best, VF& distance2) {
  const hn::RebindToSigned<DF> di;
  const VF dx = hn::Sub(qx, GatherField(df, points, at, kX)), dy = hn::Sub(qy, GatherField(df, points, at, kY));
  const VF d = hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy));
  best = hn::IfThenElse(hn::RebindMask(di, hn::Lt(d, distance2)), at, best);
  distance2 = hn::Min(d, distance2);
}

// Index of the nearest of the grid's answer and its two neighbours on either side; `found` says where there is one.
// Each of `walks` goes on from there along the surface, as long as it gets nearer: in wide places many points share a
// cell.
template <class DF, class VF = hn::Vec<DF>, class VI = hn::Vec<hn::RebindToSigned<DF>>, class M = hn::Mask<DF>>
HWY_INLINE VI FindNearest(DF df, const NearestGrid::View& grid, const float* points, int last, VF qx, VF qy, M& found,
                          VF& distance2, int walks = 0) {
  const hn::RebindToSigned<DF> di;
  const VF zero = hn::Zero(df), top = hn::Set(df, grid.limit - 1.0F);
  const VF u = hn::Mul(hn::Add(qx, hn::Set(df, grid.offset)), hn::Set(df, grid.inverse_cell));
  const VF v = hn::Mul(hn::Add(qy, hn::Set(df, grid.offset)), hn::Set(df, grid.inverse_cell));
  const VF uc = hn::Min(hn::Max(u, zero), top), vc = hn::Min(hn::Max(v, zero), top);
  const auto inside = hn::And(hn::And(hn::Ge(u, zero), hn::Ge(v, zero)), hn::And(hn::Le(u, top), hn::Le(v, top)));
  const VI cell =
      hn::Add(hn::Mul(hn::ConvertTo(di, vc), hn::Set(di, static_cast<int>(grid.stride))), hn::ConvertTo(di, uc));
  const VI key = hn::GatherIndex(di, reinterpret_cast<const std::int32_t*>(grid.keys), cell);
  const VI near = hn::Sub(hn::And(key, hn::Set(di, static_cast<int>(NearestGrid::kIndexMask))), hn::Set(di, 1));
  const VI low = hn::Zero(di), high = hn::Set(di, last);
  found = hn::And(inside, hn::RebindMask(df, hn::Gt(near, hn::Set(di, -1))));
  VI best = hn::Max(near, low);
  distance2 = hn::Set(df, 1e30F);
  for (const int step : {-2, -1, 0, 1, 2}) {
    const VI at = hn::Min(hn::Max(hn::Add(near, hn::Set(di, step)), low), high);
    TakeNearer(df, points, at, qx, qy, best, distance2);
  }
  for (int walk = 0; walk < walks; ++walk) {
    const VI centre = best;
    for (const int step : {-3, -2, -1, 1, 2, 3}) {
      const VI at = hn::Min(hn::Max(hn::Add(centre, hn::Set(di, step)), low), high);
      TakeNearer(df, points, at, qx, qy, best, distance2);
    }
  }
  return best;
}

}  // namespace HWY_NAMESPACE
}  // namespace phasescan
HWY_AFTER_NAMESPACE();

#endif
