#include "match/evidence.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "match/evidence.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/directions-inl.hpp"
#include "refine/nearest-inl.hpp"

namespace phasescan {
#ifndef PHASESCAN_EVIDENCE_TASK
#define PHASESCAN_EVIDENCE_TASK
// One call of the kernel. Sums: matched, violation, occluded, empty, stray, silent.
struct EvidenceTask {
  NearestGrid::View grid;
  const float *points, *point_sigma;
  int last;
  const float *near_range, *far_range, *empty_to;
  int bins;
  float noise_floor, noise_per_metre;
  const SurfaceBatch* hits;
  float c, s, tx, ty, slack;
  float sums[6];
};
#endif
}  // namespace phasescan

HWY_BEFORE_NAMESPACE();
namespace phasescan {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void SumEvidence(EvidenceTask& task) {
  const hn::CappedTag<float, SurfaceBatch::kPadding> df;
  using V = hn::Vec<decltype(df)>;
  const hn::RebindToSigned<decltype(df)> di;
  const SurfaceBatch& hits = *task.hits;
  const V c = hn::Set(df, task.c), s = hn::Set(df, task.s), tx = hn::Set(df, task.tx), ty = hn::Set(df, task.ty);
  const V slack = hn::Set(df, task.slack), slack2 = hn::Set(df, task.slack * task.slack);
  const V zero = hn::Zero(df), one = hn::Set(df, 1.0F), half = hn::Set(df, 0.5F);
  V matched = zero, violation = zero, occluded = zero, empty = zero, stray = zero, silent = zero;
  NearestBlock block;
  PartnerBlock partner;
  alignas(64) float other_sigma_of[kBlock], low_of[kBlock], high_of[kBlock], reach_of[kBlock];
  alignas(64) std::int32_t bin_of[kBlock];
  const V bins = hn::Set(df, static_cast<float>(task.bins));
  for (std::size_t from = 0; from < hits.padded(); from += kBlock) {
    const std::size_t size = hits.padded() - from < kBlock ? hits.padded() - from : kBlock;
    for (std::size_t k = 0; k < size; k += hn::Lanes(df)) {
      const V px = hn::LoadU(df, hits.x.data() + from + k), py = hn::LoadU(df, hits.y.data() + from + k);
      const V qx = hn::Add(hn::Sub(hn::Mul(c, px), hn::Mul(s, py)), tx),
              qy = hn::Add(hn::Add(hn::Mul(s, px), hn::Mul(c, py)), ty);
      hn::Store(qx, df, block.qx + k);
      hn::Store(qy, df, block.qy + k);
      const auto bin = hn::ConvertTo(di, hn::Mul(DirectionTurns(df, qx, qy), bins));
      hn::Store(hn::Max(hn::Min(bin, hn::Set(di, task.bins - 1)), hn::Zero(di)), di, bin_of + k);
    }
    FindNearest(df, task.grid, task.points, task.last, size, 0, block);
    CopyPartners(task.points, block.index, size, partner);
    for (std::size_t j = 0; j < size; ++j) {
      other_sigma_of[j] = task.point_sigma[block.index[j]];
      low_of[j] = task.near_range[bin_of[j]];
      high_of[j] = task.far_range[bin_of[j]];
      reach_of[j] = task.empty_to[bin_of[j]];
    }
    for (std::size_t k = 0; k < size; k += hn::Lanes(df)) {
      const V qx = hn::Load(df, block.qx + k), qy = hn::Load(df, block.qy + k);
      const V sigma = hn::LoadU(df, hits.sigma.data() + from + k),
              weight = hn::LoadU(df, hits.weight.data() + from + k);
      V match = zero;
      const auto found = hn::RebindMask(df, hn::Ne(hn::Load(di, block.found + k), hn::Zero(di)));
      if (!hn::AllFalse(df, found)) {
        const V mx = hn::LoadU(df, hits.nx.data() + from + k), my = hn::LoadU(df, hits.ny.data() + from + k);
        const V ax = hn::Sub(hn::Mul(c, mx), hn::Mul(s, my)), ay = hn::Add(hn::Mul(s, mx), hn::Mul(c, my));
        V nx, ny, line_x, line_y, length, variance;
        hn::LoadInterleaved2(df, partner.normal + 2 * k, nx, ny);
        hn::LoadInterleaved2(df, partner.line + 2 * k, line_x, line_y);
        hn::LoadInterleaved2(df, partner.measure + 2 * k, length, variance);
        const auto both =
            hn::And(hn::Gt(hn::Add(hn::Abs(mx), hn::Abs(my)), zero), hn::Gt(hn::Add(hn::Abs(nx), hn::Abs(ny)), zero));
        const V cosine = hn::Add(hn::Mul(nx, ax), hn::Mul(ny, ay));
        const V facing = hn::Min(hn::Max(hn::Mul(hn::Sub(cosine, hn::Set(df, 0.4F)), hn::Set(df, 2.0F)), zero), one);
        const V agree = hn::IfThenElse(both, facing, hn::Set(df, 0.6F));
        const V dx = hn::Sub(qx, line_x), dy = hn::Sub(qy, line_y);
        const V d = hn::Add(hn::Mul(dx, nx), hn::Mul(dy, ny));
        const V reach = hn::Mul(half, hn::Add(length, hn::LoadU(df, hits.length.data() + from + k)));
        const V along = hn::Max(zero, hn::Sub(hn::Abs(hn::Sub(hn::Mul(dy, nx), hn::Mul(dx, ny))), reach));
        const V across =
            hn::IfThenElse(both, hn::Add(hn::Mul(d, d), hn::Mul(along, along)), hn::Load(df, block.distance2 + k));
        const V other_sigma = hn::Load(df, other_sigma_of + k);
        const V noise = hn::Add(hn::Add(hn::Mul(sigma, sigma), hn::Mul(other_sigma, other_sigma)), slack2);
        const V near = hn::Max(zero, hn::Sub(one, hn::Div(across, hn::Mul(hn::Set(df, 9.0F), noise))));
        match = hn::IfThenElseZero(found, hn::Mul(agree, near));
      }
      const V rest = hn::Mul(weight, hn::Sub(one, match));
      matched = hn::Add(matched, hn::Mul(weight, match));
      const V r = hn::Sqrt(hn::Add(hn::Mul(qx, qx), hn::Mul(qy, qy)));
      const V ref_sigma = hn::Max(hn::Set(df, task.noise_floor), hn::Mul(hn::Set(df, task.noise_per_metre), r));
      const V margin = hn::Add(hn::Mul(hn::Set(df, 3.0F), hn::Max(sigma, ref_sigma)), slack);
      const V low = hn::Load(df, low_of + k), high = hn::Load(df, high_of + k), reach = hn::Load(df, reach_of + k);
      const auto near_enough = hn::Ge(match, hn::Set(df, 0.8F));
      const auto seen = hn::Gt(high, zero);
      const auto before = hn::And(hn::Lt(r, hn::Sub(low, margin)), seen),
                 behind = hn::And(hn::Gt(r, hn::Add(high, margin)), seen);
      const auto is_violation = hn::AndNot(near_enough, before), is_occluded = hn::AndNot(near_enough, behind);
      const auto is_empty = hn::AndNot(hn::Or(near_enough, seen), hn::Lt(r, reach)),
                 is_silent = hn::AndNot(hn::Or(near_enough, seen), hn::Ge(r, reach));
      const V violating = hn::IfThenElseZero(is_violation, rest), occluding = hn::IfThenElseZero(is_occluded, rest);
      const V emptying = hn::IfThenElseZero(is_empty, rest), silencing = hn::IfThenElseZero(is_silent, rest);
      violation = hn::Add(violation, violating);
      occluded = hn::Add(occluded, occluding);
      empty = hn::Add(empty, emptying);
      silent = hn::Add(silent, silencing);
      stray = hn::Add(stray, hn::Sub(hn::Sub(rest, hn::Add(violating, occluding)), hn::Add(emptying, silencing)));
    }
  }
  const V all[] = {matched, violation, occluded, empty, stray, silent};
  for (int k = 0; k < 6; ++k) task.sums[k] = hn::GetLane(hn::SumOfLanes(df, all[k]));
}

}  // namespace HWY_NAMESPACE
}  // namespace phasescan
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <cmath>

namespace phasescan {
HWY_EXPORT(SumEvidence);

namespace {

// Adds what `other` says of `hits`, seen at T_other_hits.
void weigh_one_way(const PreparedScan& other, const SurfaceBatch& hits, const Pose2& T_other_hits, double slack_m,
                   Evidence& sum) {
  if (other.size() == 0 || hits.count == 0) return;
  const SurfacePoints& surface = other.surface;
  EvidenceTask task{other.nearest.view(),
                    &surface.points.front().x,
                    surface.sigma.data(),
                    static_cast<int>(surface.size()) - 1,
                    other.bearings.near_range.data(),
                    other.bearings.far_range.data(),
                    other.bearings.empty_to.data(),
                    static_cast<int>(other.bearings.size()),
                    surface.noise.floor_m,
                    surface.noise.per_metre,
                    &hits,
                    static_cast<float>(std::cos(T_other_hits.theta)),
                    static_cast<float>(std::sin(T_other_hits.theta)),
                    static_cast<float>(T_other_hits.x),
                    static_cast<float>(T_other_hits.y),
                    static_cast<float>(slack_m),
                    {}};
  HWY_DYNAMIC_DISPATCH(SumEvidence)(task);
  sum.matched += static_cast<double>(task.sums[0]);
  sum.violation += static_cast<double>(task.sums[1]);
  sum.occluded += static_cast<double>(task.sums[2]);
  sum.empty += static_cast<double>(task.sums[3]);
  sum.stray += static_cast<double>(task.sums[4]);
  sum.silent += static_cast<double>(task.sums[5]);
  sum.hits += static_cast<int>(hits.count);
}

}  // namespace

Evidence weigh_evidence(const PreparedScan& reference, const PreparedScan& scan, const SurfaceBatch& reference_hits,
                        const SurfaceBatch& scan_hits, const Pose2& T_ref_scan, double slack_m) {
  Evidence sum;
  weigh_one_way(reference, scan_hits, T_ref_scan, slack_m, sum);
  weigh_one_way(scan, reference_hits, T_ref_scan.inverse(), slack_m, sum);
  return sum;
}

}  // namespace phasescan
#endif
