#include "scan/bearing_table.hpp"

#include <algorithm>
#include <cmath>

namespace phasescan {
namespace {

constexpr float kNothing = 1e30F;
constexpr int kMinBins = 90, kMaxBins = 720;
constexpr double kReachKept = 0.85;  // a sensor loses surfaces before its stated range_max

int bin_count(const Scan& scan, double spacing) {
  if (scan.size() < 2 || !(spacing > 0.0)) return kMinBins;
  return static_cast<int>(std::clamp(std::round(kTwoPi / spacing), double{kMinBins}, double{kMaxBins}));
}

int bin_of_angle(double angle, int bins) {
  const auto bin = static_cast<int>(wrap_positive(angle) * (static_cast<double>(bins) / kTwoPi));
  return std::min(bin, bins - 1);
}

}  // namespace

void fill_bearing_table(const Scan& scan, const SurfacePoints& surface, const float* hit_turns,
                        const SurfaceWorkspace& beams, double twist_turn_per_beam, double min_empty_run_rad,
                        BearingWorkspace& work, BearingTable& out) {
  const int bins = bin_count(scan, surface.spacing);
  const auto size = static_cast<std::size_t>(bins);
  work.low.assign(size, kNothing);
  work.high.assign(size, 0.0F);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const auto bin = std::min(static_cast<std::size_t>(hit_turns[i] * static_cast<float>(bins)), size - 1);
    work.low[bin] = std::min(work.low[bin], surface.range[i]);
    work.high[bin] = std::max(work.high[bin], surface.range[i]);
  }
  // Wide runs of beams without return.
  work.missing.assign(size, 0);
  const auto reach = static_cast<float>(kReachKept * scan.effective_range_max());
  const std::size_t n = beams.order.size();
  for (std::size_t begin = 0; begin < n;) {
    const auto state = [&](std::size_t k) { return scan.states[static_cast<std::size_t>(beams.order[k])]; };
    if (state(begin) == BeamState::kHit || state(begin) == BeamState::kTooNear) {
      ++begin;
      continue;
    }
    std::size_t end = begin;
    while (end < n && state(end) != BeamState::kHit && state(end) != BeamState::kTooNear) ++end;
    const double width = beams.angle[end - 1] - beams.angle[begin] + surface.spacing;
    if (width >= min_empty_run_rad) {
      for (std::size_t k = begin; k < end; ++k) {
        const double turn = twist_turn_per_beam * static_cast<double>(beams.order[k]);
        work.missing[static_cast<std::size_t>(bin_of_angle(beams.angle[k] + turn, bins))] = 1;
      }
    }
    begin = end;
  }
  out.near_range.resize(size);
  out.far_range.resize(size);
  out.empty_to.resize(size);
  for (std::size_t k = 0; k < size; ++k) {
    const std::size_t before = k == 0 ? size - 1 : k - 1, after = k + 1 == size ? 0 : k + 1;
    const float low = std::min({work.low[before], work.low[k], work.low[after]});
    const float high = std::max({work.high[before], work.high[k], work.high[after]});
    const bool hit = high > 0.0F;
    out.near_range[k] = hit ? low : 0.0F;
    out.far_range[k] = high;
    out.empty_to[k] = !hit && work.missing[k] ? reach : 0.0F;
  }
}

}  // namespace phasescan
