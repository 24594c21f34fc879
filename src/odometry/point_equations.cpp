#include "odometry/point_equations.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "odometry/point_equations.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace phasescan {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void SumPoints(const PointPartners& p, const PointGate& gate, PointSums& sums) {
  const hn::CappedTag<float, PointPartners::kPadding> df;
  using V = hn::Vec<decltype(df)>;
  const V across = hn::Set(df, gate.across_m), along_limit = hn::Set(df, gate.along_m), widen = hn::Set(df, gate.widen),
          width = hn::Set(df, gate.kernel_variances), one = hn::Set(df, 1.0F);
  V xx = hn::Zero(df), xy = xx, xt = xx, yy = xx, yt = xx, tt = xx, gx = xx, gy = xx, gt = xx;
  V lxx = xx, lxy = xx, lxt = xx, lyy = xx, lyt = xx, ltt = xx, squares = xx, efficiency = xx, partners = xx;
  for (std::size_t k = 0; k < p.count; k += hn::Lanes(df)) {
    const V nx = hn::LoadU(df, p.nx.data() + k), ny = hn::LoadU(df, p.ny.data() + k);
    const V dx = hn::LoadU(df, p.dx.data() + k), dy = hn::LoadU(df, p.dy.data() + k);
    const V e = hn::Add(hn::Mul(dx, nx), hn::Mul(dy, ny));
    const V along = hn::Sub(hn::Mul(dy, nx), hn::Mul(dx, ny));
    const auto good =
        hn::And(hn::FirstN(df, p.count - k), hn::And(hn::Le(hn::Abs(e), across), hn::Le(hn::Abs(along), along_limit)));
    if (hn::AllFalse(df, good)) continue;
    const V sharp = hn::LoadU(df, p.variance.data() + k), variance = hn::Add(sharp, widen);
    const V squared = hn::Mul(e, e);
    const V kernel = hn::Div(one, hn::Add(one, hn::Div(squared, hn::Mul(width, variance))));
    const V w = hn::IfThenElseZero(good, hn::Div(hn::Mul(kernel, kernel), variance));
    efficiency = hn::Add(efficiency, hn::IfThenElseZero(good, hn::Div(sharp, variance)));
    squares = hn::Add(squares, hn::IfThenElseZero(good, squared));
    partners = hn::Add(partners, hn::IfThenElseZero(good, one));
    const V rx = hn::LoadU(df, p.rx.data() + k), ry = hn::LoadU(df, p.ry.data() + k);
    const V jt = hn::Sub(hn::Mul(rx, ny), hn::Mul(ry, nx));
    const V wx = hn::Mul(w, nx), wy = hn::Mul(w, ny), wt = hn::Mul(w, jt);
    xx = hn::Add(xx, hn::Mul(wx, nx));
    xy = hn::Add(xy, hn::Mul(wx, ny));
    xt = hn::Add(xt, hn::Mul(wx, jt));
    yy = hn::Add(yy, hn::Mul(wy, ny));
    yt = hn::Add(yt, hn::Mul(wy, jt));
    tt = hn::Add(tt, hn::Mul(wt, jt));
    gx = hn::Add(gx, hn::Mul(wx, e));
    gy = hn::Add(gy, hn::Mul(wy, e));
    gt = hn::Add(gt, hn::Mul(wt, e));
    // Along the tangent (ny, -nx) in place of the normal.
    const V noise = hn::Mul(w, hn::LoadU(df, p.normal_variance.data() + k));
    const V lt = hn::Neg(hn::Add(hn::Mul(rx, nx), hn::Mul(ry, ny)));
    const V ux = hn::Mul(noise, ny), uy = hn::Mul(noise, nx), ut = hn::Mul(noise, lt);
    lxx = hn::Add(lxx, hn::Mul(ux, ny));
    lxy = hn::Sub(lxy, hn::Mul(ux, nx));
    lxt = hn::Add(lxt, hn::Mul(ux, lt));
    lyy = hn::Add(lyy, hn::Mul(uy, nx));
    lyt = hn::Sub(lyt, hn::Mul(uy, lt));
    ltt = hn::Add(ltt, hn::Mul(ut, lt));
  }
  const V h[6] = {xx, xy, xt, yy, yt, tt}, l[6] = {lxx, lxy, lxt, lyy, lyt, ltt}, g[3] = {gx, gy, gt};
  for (int i = 0; i < 6; ++i) {
    sums.H[i] = hn::GetLane(hn::SumOfLanes(df, h[i]));
    sums.normal_noise[i] = hn::GetLane(hn::SumOfLanes(df, l[i]));
  }
  for (int i = 0; i < 3; ++i) sums.g[i] = hn::GetLane(hn::SumOfLanes(df, g[i]));
  sums.squares = hn::GetLane(hn::SumOfLanes(df, squares));
  sums.efficiency = hn::GetLane(hn::SumOfLanes(df, efficiency));
  sums.partners = static_cast<int>(hn::GetLane(hn::SumOfLanes(df, partners)));
}

}  // namespace HWY_NAMESPACE
}  // namespace phasescan
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace phasescan {
HWY_EXPORT(SumPoints);

PointSums sum_point_equations(const PointPartners& partners, const PointGate& gate) {
  PointSums sums;
  HWY_DYNAMIC_DISPATCH(SumPoints)(partners, gate, sums);
  return sums;
}

}  // namespace phasescan
#endif
