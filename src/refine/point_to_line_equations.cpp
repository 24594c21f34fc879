#include "refine/point_to_line.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "refine/point_to_line_equations.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "refine/nearest-inl.hpp"

namespace phasescan {
#ifndef PHASESCAN_LINE_TASK
#define PHASESCAN_LINE_TASK
// One call of the kernel. Sums: H (xx, xy, xt, yy, yt, tt), g (x, y, t), leak of the normals (as H), cost, partners.
struct LineTask {
  NearestGrid::View grid;
  const float* points;
  const float* normal_variance;
  int last;
  const float *x, *y, *nx, *ny, *length, *variance;
  std::size_t count, padded;
  std::int32_t* partners;
  bool known;
  float c, s, tx, ty, gate, soft, min_cosine;
  float sums[17];
};
#endif
}  // namespace phasescan

HWY_BEFORE_NAMESPACE();
namespace phasescan {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void SumEquations(LineTask& task) {
  const hn::CappedTag<float, SurfaceBatch::kPadding> df;
  using V = hn::Vec<decltype(df)>;
  const hn::RebindToSigned<decltype(df)> di;
  const V c = hn::Set(df, task.c), s = hn::Set(df, task.s), tx = hn::Set(df, task.tx), ty = hn::Set(df, task.ty);
  const V gate = hn::Set(df, task.gate), min_cosine = hn::Set(df, task.min_cosine), half = hn::Set(df, 0.5F),
          zero = hn::Zero(df);
  constexpr float kModelVariance = 5e-5F;  // [m^2] (7 mm): surfaces are not lines, and ranges err together
  const V base = hn::Set(df, kModelVariance + task.soft * task.soft), width = hn::Set(df, 4.0F);
  const bool with_leak = task.soft == 0.0F;
  const int walks = with_leak ? 2 : 0;  // the first steps need no better partner
  V xx = hn::Zero(df), xy = xx, xt = xx, yy = xx, yt = xx, tt = xx, gx = xx, gy = xx, gt = xx;
  V lxx = xx, lxy = xx, lxt = xx, lyy = xx, lyt = xx, ltt = xx, cost = xx, partners = xx;
  const V one = hn::Set(df, 1.0F);
  NearestBlock block;
  PartnerBlock partner;
  alignas(64) float rx_of[kBlock], ry_of[kBlock], normal_variance[kBlock];
  for (std::size_t from = 0; from < task.padded; from += kBlock) {
    const std::size_t size = task.padded - from < kBlock ? task.padded - from : kBlock;
    for (std::size_t k = 0; k < size; k += hn::Lanes(df)) {
      const V px = hn::LoadU(df, task.x + from + k), py = hn::LoadU(df, task.y + from + k);
      const V rx = hn::Sub(hn::Mul(c, px), hn::Mul(s, py)), ry = hn::Add(hn::Mul(s, px), hn::Mul(c, py));
      hn::Store(rx, df, rx_of + k);
      hn::Store(ry, df, ry_of + k);
      hn::Store(hn::Add(rx, tx), df, block.qx + k);
      hn::Store(hn::Add(ry, ty), df, block.qy + k);
    }
    if (task.known) {
      for (std::size_t j = 0; j < size; ++j) {
        const std::int32_t noted = task.partners[from + j];
        block.found[j] = noted < 0 ? 0 : -1;
        block.index[j] = noted < 0 ? 0 : noted;
      }
    } else {
      FindNearest(df, task.grid, task.points, task.last, size, walks, block);
      if (task.partners != nullptr) {
        for (std::size_t j = 0; j < size; ++j) task.partners[from + j] = block.found[j] != 0 ? block.index[j] : -1;
      }
    }
    CopyPartners(task.points, block.index, size, partner);
    if (with_leak) {
      for (std::size_t j = 0; j < size; ++j) normal_variance[j] = task.normal_variance[block.index[j]];
    }
    for (std::size_t k = 0; k < size; k += hn::Lanes(df)) {
      if (from + k >= task.count) break;
      const auto found = hn::And(hn::RebindMask(df, hn::Ne(hn::Load(di, block.found + k), hn::Zero(di))),
                                 hn::FirstN(df, task.count - from - k));  // the padding is no hit
      if (hn::AllFalse(df, found)) continue;
      const V rx = hn::Load(df, rx_of + k), ry = hn::Load(df, ry_of + k);
      const V mx = hn::LoadU(df, task.nx + from + k), my = hn::LoadU(df, task.ny + from + k);
      const V ax = hn::Sub(hn::Mul(c, mx), hn::Mul(s, my)), ay = hn::Add(hn::Mul(s, mx), hn::Mul(c, my));
      V nx, ny, line_x, line_y, line_length, line_variance;
      hn::LoadInterleaved2(df, partner.normal + 2 * k, nx, ny);
      hn::LoadInterleaved2(df, partner.line + 2 * k, line_x, line_y);
      hn::LoadInterleaved2(df, partner.measure + 2 * k, line_length, line_variance);
      // A lone hit has no line of its own, but it knows where the other's line is as well as the rest. Where the other
      // has none, both are false.
      const auto lone =
          hn::And(hn::Eq(hn::Add(hn::Abs(mx), hn::Abs(my)), zero), hn::Gt(hn::Add(hn::Abs(nx), hn::Abs(ny)), zero));
      auto good = hn::And(found, hn::Or(lone, hn::Ge(hn::Add(hn::Mul(nx, ax), hn::Mul(ny, ay)), min_cosine)));
      const V dx = hn::Sub(hn::Load(df, block.qx + k), line_x), dy = hn::Sub(hn::Load(df, block.qy + k), line_y);
      const V residual = hn::Add(hn::Mul(dx, nx), hn::Mul(dy, ny));
      const V along = hn::Sub(hn::Mul(dy, nx), hn::Mul(dx, ny));
      const V own_length = hn::LoadU(df, task.length + from + k);
      good = hn::And(good, hn::Le(hn::Abs(residual), gate));
      // In the last steps the line is believed no farther than the hits on it, or those of the other scan, are apart.
      const V reach = with_leak ? hn::Mul(hn::Set(df, 1.5F), hn::Max(line_length, own_length))
                                : hn::Add(gate, hn::Mul(half, line_length));
      good = hn::And(good, hn::Le(hn::Abs(along), reach));
      if (hn::AllFalse(df, good)) continue;
      // One over the variance of the residual: the point stands for `length` of surface, the line is seen by beams that
      // stand for line_length each. Times the kernel (Geman-McClure): far residuals count less.
      const V spread = hn::Div(hn::Mul(line_variance, line_length), own_length);
      const V widened = hn::Mul(width, hn::Add(hn::Add(hn::LoadU(df, task.variance + from + k), spread), base));
      const V below = hn::Add(widened, hn::Mul(residual, residual));
      const V w = hn::IfThenElseZero(good, hn::Div(hn::Mul(width, widened), hn::Mul(below, below)));
      const V jt = hn::Sub(hn::Mul(rx, ny), hn::Mul(ry, nx));
      const V wx = hn::Mul(w, nx), wy = hn::Mul(w, ny), wt = hn::Mul(w, jt);
      xx = hn::Add(xx, hn::Mul(wx, nx));
      xy = hn::Add(xy, hn::Mul(wx, ny));
      xt = hn::Add(xt, hn::Mul(wx, jt));
      yy = hn::Add(yy, hn::Mul(wy, ny));
      yt = hn::Add(yt, hn::Mul(wy, jt));
      tt = hn::Add(tt, hn::Mul(wt, jt));
      gx = hn::Add(gx, hn::Mul(wx, residual));
      gy = hn::Add(gy, hn::Mul(wy, residual));
      gt = hn::Add(gt, hn::Mul(wt, residual));
      cost = hn::Add(cost, hn::Mul(hn::Mul(w, residual), residual));
      partners = hn::Add(partners, hn::IfThenElseZero(good, one));
      if (!with_leak) continue;
      // Along the tangent (-ny, nx), which turns by `turn`, a noisy normal leaks weight * variance of information.
      const V leak = hn::Mul(w, hn::Load(df, normal_variance + k));
      const V turn = hn::Add(hn::Mul(rx, nx), hn::Mul(ry, ny));
      const V ux = hn::Mul(leak, ny), uy = hn::Mul(leak, nx), ut = hn::Mul(leak, turn);
      lxx = hn::Add(lxx, hn::Mul(ux, ny));
      lxy = hn::Sub(lxy, hn::Mul(ux, nx));
      lxt = hn::Sub(lxt, hn::Mul(ut, ny));
      lyy = hn::Add(lyy, hn::Mul(uy, nx));
      lyt = hn::Add(lyt, hn::Mul(ut, nx));
      ltt = hn::Add(ltt, hn::Mul(ut, turn));
    }
  }
  const V all[] = {xx, xy, xt, yy, yt, tt, gx, gy, gt, lxx, lxy, lxt, lyy, lyt, ltt, cost, partners};
  for (int k = 0; k < 17; ++k) task.sums[k] = hn::GetLane(hn::SumOfLanes(df, all[k]));
}

}  // namespace HWY_NAMESPACE
}  // namespace phasescan
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <algorithm>
#include <cmath>

namespace phasescan {
HWY_EXPORT(SumEquations);

namespace {

// Equations of the `count` hits from `from` on, a multiple of the padding.
NormalEquations equations_of(const SurfaceModel& model, const SurfaceBatch& hits, std::size_t from, std::size_t count,
                             const Pose2& T_model_hits, const PartnerGate& gate, Partners* partners) {
  constexpr std::size_t kPadding = SurfaceBatch::kPadding;
  LineTask task{model.grid.view(),
                &model.points.points.front().x,
                model.points.normal_variance.data(),
                static_cast<int>(model.points.size()) - 1,
                hits.x.data() + from,
                hits.y.data() + from,
                hits.nx.data() + from,
                hits.ny.data() + from,
                hits.length.data() + from,
                hits.variance.data() + from,
                count,
                (count + kPadding - 1) / kPadding * kPadding,
                partners != nullptr ? partners->index.data() + from : nullptr,
                partners != nullptr && partners->known,
                static_cast<float>(std::cos(T_model_hits.theta)),
                static_cast<float>(std::sin(T_model_hits.theta)),
                static_cast<float>(T_model_hits.x),
                static_cast<float>(T_model_hits.y),
                static_cast<float>(gate.gate_m),
                static_cast<float>(gate.soft_m),
                static_cast<float>(gate.min_normal_cosine),
                {}};
  HWY_DYNAMIC_DISPATCH(SumEquations)(task);
  const auto symmetric = [](const float* v) {
    Eigen::Matrix3f full;
    full << v[0], v[1], v[2], v[1], v[3], v[4], v[2], v[4], v[5];
    return full.cast<double>().eval();
  };
  NormalEquations out;
  out.H = symmetric(task.sums);
  out.g = Eigen::Vector3f(task.sums[6], task.sums[7], task.sums[8]).cast<double>();
  out.normal_noise = symmetric(task.sums + 9);
  out.cost = static_cast<double>(task.sums[15]);
  out.partners = static_cast<int>(task.sums[16]);
  return out;
}

}  // namespace

NormalEquations point_to_line_equations(const SurfaceModel& model, const SurfaceBatch& hits, const Pose2& T_model_hits,
                                        const PartnerGate& gate, Partners* partners) {
  if (model.points.size() == 0 || model.grid.empty() || hits.count == 0) return {};
  if (partners != nullptr && !partners->known) partners->index.resize(hits.padded());
  const NormalEquations out = equations_of(model, hits, 0, hits.count, T_model_hits, gate, partners);
  if (partners != nullptr) partners->known = true;
  return out;
}

void point_to_line_equations_by_run(const SurfaceModel& model, const SurfaceBatch& hits, const Pose2& T_model_hits,
                                    const PartnerGate& gate, Partners& partners, std::vector<NormalEquations>& out) {
  out.clear();
  if (model.points.size() == 0 || model.grid.empty()) return;
  Partners* const known = partners.known && partners.index.size() == hits.padded() ? &partners : nullptr;
  for (std::size_t from = 0; from < hits.count; from += kRunOfHits)
    out.push_back(equations_of(model, hits, from, std::min(kRunOfHits, hits.count - from), T_model_hits, gate, known));
}

NormalEquations about_inverse(const NormalEquations& equations, const Pose2& T) {
  const double c = std::cos(T.theta), s = std::sin(T.theta);
  Eigen::Matrix3d M;  // d(T^-1) / dT
  M << -c, -s, s * T.x - c * T.y, s, -c, c * T.x + s * T.y, 0.0, 0.0, -1.0;
  NormalEquations out = equations;
  out.H = M.transpose() * equations.H * M;
  out.normal_noise = M.transpose() * equations.normal_noise * M;
  out.g = M.transpose() * equations.g;
  return out;
}

}  // namespace phasescan
#endif
