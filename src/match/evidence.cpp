#include "phasescan/match/evidence.hpp"

#include <algorithm>
#include <cmath>

#include "phasescan/core/fast_math.hpp"

namespace phasescan {
namespace {

// Adds what `other` says of `hits` of `mine`, seen at T_other_mine.
void weigh_one_way(const PreparedScan& other, const SurfacePoints& mine, std::span<const int> hits, const Pose2& T_other_mine,
                   float slack, Evidence& sum) {
  const auto c = static_cast<float>(std::cos(T_other_mine.theta)), s = static_cast<float>(std::sin(T_other_mine.theta));
  const auto tx = static_cast<float>(T_other_mine.x), ty = static_cast<float>(T_other_mine.y);
  const SurfacePoints& ref = other.surface;
  const BearingTable& table = other.bearings;
  const auto bins = static_cast<float>(table.size());
  const auto last_bin = table.size() - 1;
  const int last = static_cast<int>(ref.size()) - 1;
  float matched = 0, violation = 0, occluded = 0, empty = 0, stray = 0, silent = 0;
  for (const int hit : hits) {
    const SurfacePoint& from = mine[static_cast<std::size_t>(hit)];
    const float sigma = mine.sigma[static_cast<std::size_t>(hit)];
    const float qx = c * from.x - s * from.y + tx, qy = s * from.x + c * from.y + ty;
    float match = 0.0F;
    const int near = other.nearest.nearest(qx, qy);
    if (near >= 0) {
      float best = 1e30F;
      int index = near;
      for (int k = std::max(near - 2, 0); k <= std::min(near + 2, last); ++k) {
        const float dx = qx - ref[static_cast<std::size_t>(k)].x, dy = qy - ref[static_cast<std::size_t>(k)].y;
        const float d = dx * dx + dy * dy;
        if (d < best) {
          best = d;
          index = k;
        }
      }
      const SurfacePoint& to = ref[static_cast<std::size_t>(index)];
      float across = best, agree = 0.6F;
      if (from.has_normal() && to.has_normal()) {
        const float nx = c * from.nx - s * from.ny, ny = s * from.nx + c * from.ny;
        agree = std::clamp((nx * to.nx + ny * to.ny - 0.4F) * 2.0F, 0.0F, 1.0F);
        const float dx = qx - to.line_x, dy = qy - to.line_y;
        const float d = dx * to.nx + dy * to.ny;
        const float along = std::max(0.0F, std::fabs(dy * to.nx - dx * to.ny) - 0.5F * (to.length + from.length));
        across = d * d + along * along;
      }
      const float other_sigma = ref.sigma[static_cast<std::size_t>(index)];
      const float noise = sigma * sigma + other_sigma * other_sigma + slack * slack;
      match = agree * std::max(0.0F, 1.0F - across / (9.0F * noise));
    }
    matched += match;
    const float rest = 1.0F - match;
    if (rest < 0.2F) {
      stray += rest;
      continue;
    }
    const float r = std::sqrt(qx * qx + qy * qy);
    const auto bin = std::min(static_cast<std::size_t>(direction_turns(qx, qy) * bins), last_bin);
    const float margin = 3.0F * std::max(sigma, ref.noise.sigma(r)) + slack;
    const float low = table.near_range[bin], high = table.far_range[bin], reach = table.empty_to[bin];
    if (high > 0.0F) {
      (r < low - margin ? violation : r > high + margin ? occluded : stray) += rest;
    } else {
      (r < reach ? empty : silent) += rest;
    }
  }
  sum.matched += static_cast<double>(matched);
  sum.violation += static_cast<double>(violation);
  sum.occluded += static_cast<double>(occluded);
  sum.empty += static_cast<double>(empty);
  sum.stray += static_cast<double>(stray);
  sum.silent += static_cast<double>(silent);
  sum.hits += static_cast<int>(hits.size());
}

}  // namespace

Evidence weigh_evidence(const PreparedScan& reference, const PreparedScan& scan, std::span<const int> reference_hits,
                        std::span<const int> scan_hits, const Pose2& T_ref_scan, double slack_m) {
  Evidence sum;
  const auto slack = static_cast<float>(slack_m);
  weigh_one_way(reference, scan.surface, scan_hits, T_ref_scan, slack, sum);
  weigh_one_way(scan, reference.surface, reference_hits, T_ref_scan.inverse(), slack, sum);
  return sum;
}

}  // namespace phasescan
