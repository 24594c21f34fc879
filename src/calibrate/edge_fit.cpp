#include "calibrate/edge_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace phasescan {
namespace {

/// Beams from the edge on: 0 is the last one of a surface, then those beside it.
constexpr std::size_t kDepth = 4;

struct EdgeSums {
  std::array<double, kDepth> shares{};
  std::array<double, kDepth> counts{};
  double between = 0.0, answers = 0.0;
  std::size_t edges = 0;
};

/// The medians of a surface from its edge on are finite from the second one and run smoothly.
bool is_piece(const std::array<double, kDepth>& ranges, double roughness_m) {
  for (std::size_t d = 2; d < kDepth; ++d) {
    if (!(std::abs(ranges[d] - ranges[d - 1]) < roughness_m)) return false;
  }
  return true;
}

void add_edge(const StopBeams& stop, std::size_t last, EdgeSums& sums) {
  constexpr double kApart_m = 0.3, kNear_m = 0.05, kFar_m = 0.1, kLeave_near_m = 0.1, kLeave_far_m = 0.15;
  std::array<double, kDepth> before{}, after{};
  for (std::size_t d = 0; d < kDepth; ++d) {
    before[d] = stop.beams[last - d].range;
    after[d] = stop.beams[last + 1 + d].range;
  }
  const bool rises = after[1] > before[1];
  const auto& near = rises ? before : after;
  const auto& far = rises ? after : before;
  if (!is_piece(near, kNear_m) || !is_piece(far, kFar_m) || !(far[1] - near[1] > kApart_m)) return;
  // The jump is between these two beams, not one further on; a beam that never answers may be either.
  if (std::abs(near[0] - near[1]) > std::abs(near[0] - far[1])) return;
  if (std::abs(far[0] - far[1]) > std::abs(far[0] - near[1])) return;
  ++sums.edges;
  for (std::size_t d = 0; d < kDepth; ++d) {
    for (const std::size_t beam : {last - d, last + 1 + d}) {
      if (stop.beams[beam].asked == 0) continue;
      sums.shares[d] += stop.beams[beam].share();
      sums.counts[d] += 1.0;
    }
  }
  for (const std::size_t beam : {last, last + 1}) {
    double answers = 0.0, between = 0.0, sum = 0.0, sum2 = 0.0;
    for (const auto& scan : stop.stop.ranges) {
      const double range = scan[beam];
      if (std::isnan(range)) continue;
      answers += 1.0;
      if (range < near[1] + kLeave_near_m || range > far[1] - kLeave_far_m) continue;
      between += 1.0;
      sum += range;
      sum2 += range * range;
    }
    // What it says in between lies anywhere between the two; a third surface is always at the same range.
    constexpr double kScatter = 0.1;
    const double mean = sum / std::max(1.0, between), spread = sum2 / std::max(1.0, between) - mean * mean;
    const bool third = between > 0.5 * answers && spread < std::pow(kScatter * (far[1] - near[1]), 2);
    if (third) continue;
    sums.answers += answers;
    sums.between += between;
  }
}

}  // namespace

EdgeFit fit_edges(std::span<const StopBeams> stops) {
  constexpr std::size_t kLeastEdges = 20;
  EdgeSums sums;
  for (const StopBeams& stop : stops) {
    for (std::size_t i = kDepth; i + kDepth < stop.beams.size(); ++i) add_edge(stop, i, sums);
  }
  EdgeFit fit;
  fit.edges = sums.edges;
  if (sums.edges < kLeastEdges) return fit;
  const auto share = [&](std::size_t d) { return sums.shares[d] / std::max(1.0, sums.counts[d]); };
  fit.mixed = sums.between / std::max(1.0, sums.answers);
  // A loss that falls to nothing at the width, seen half a step and one and a half steps from the edge, against what
  // is lost farther away.
  const double away = std::max(1e-6, std::max(share(2), share(3)));
  const double at_half = std::max(0.0, 1.0 - share(0) / away), beside = std::max(0.0, 1.0 - share(1) / away);
  constexpr double kLeastLoss = 0.01;
  if (at_half < kLeastLoss) return fit;
  const double fall = std::max(1e-3, at_half - beside);  // a step
  fit.width_steps = beside < kLeastLoss ? 1.5 : std::clamp(0.5 + at_half / fall, 0.6, 20.0);
  fit.loss = std::min(1.0, at_half / (1.0 - 0.5 / fit.width_steps));
  return fit;
}

}  // namespace phasescan
