#include "calibrate/beams.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace phasescan {
namespace {

/// The middle value; NaN without one. Orders `values` anew.
double median(std::vector<float>& values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (static_cast<double>(*middle) + static_cast<double>(*std::max_element(values.begin(), middle)));
}

/// Runs of silent beams among those that nearly always answer.
void find_lost_sectors(StopBeams& out) {
  constexpr double kSure = 0.8, kLeast_deg = 8.0;
  constexpr std::size_t kLeastBeams = 8;
  std::vector<std::size_t> sure;
  for (std::size_t i = 0; i < out.beams.size(); ++i) {
    if (out.beams[i].share() > kSure) sure.push_back(i);
  }
  for (std::size_t k = 0; k < out.stop.size(); ++k) {
    LostSector longest{k, 0, 0};
    for (std::size_t a = 0; a < sure.size();) {
      std::size_t b = a;
      while (b < sure.size() && std::isnan(out.stop.ranges[k][sure[b]])) ++b;
      if (b - a >= kLeastBeams && sure[b - 1] - sure[a] + 1 > longest.count)
        longest = {k, sure[a], sure[b - 1] - sure[a] + 1};
      a = std::max(b, a + 1);
    }
    if (static_cast<double>(longest.count) * std::abs(rad_to_deg(out.stop.step)) >= kLeast_deg)
      out.lost.push_back(longest);
  }
}

void count_answers(StopBeams& out) {
  for (std::size_t i = 0; i < out.beams.size(); ++i) {
    BeamSummary& beam = out.beams[i];
    beam.asked = beam.answers = 0;
    for (std::size_t k = 0; k < out.stop.size(); ++k) {
      if (out.in_lost_sector(k, i)) continue;
      ++beam.asked;
      beam.answers += std::isnan(out.stop.ranges[k][i]) ? 0 : 1;
    }
  }
}

}  // namespace

bool StopBeams::in_lost_sector(std::size_t scan, std::size_t beam) const {
  return std::any_of(lost.begin(), lost.end(), [&](const LostSector& sector) {
    return sector.scan == scan && beam >= sector.first && beam < sector.first + sector.count;
  });
}

StopBeams summarise(Stop stop) {
  StopBeams out;
  out.stop = std::move(stop);
  const std::size_t n = out.stop.beams;
  out.beams.resize(n);
  std::vector<float> values;
  for (std::size_t i = 0; i < n; ++i) {
    values.clear();
    for (const auto& scan : out.stop.ranges) {
      if (!std::isnan(scan[i])) values.push_back(scan[i]);
    }
    out.beams[i].range = median(values);
  }
  count_answers(out);
  find_lost_sectors(out);
  if (!out.lost.empty()) count_answers(out);
  constexpr double kBend_m = 0.05;
  for (std::size_t i = 0; i < n; ++i) {
    if (!out.stop.closed && (i < 2 || i + 2 >= n)) continue;
    const auto at = [&](std::size_t step) { return out.beams[(i + n + step - 2) % n].range; };
    out.beams[i].slope = 0.5 * (at(3) - at(1));
    out.beams[i].smooth = std::abs(at(4) - 2.0 * at(2) + at(0)) < kBend_m && !std::isnan(out.beams[i].slope);
  }
  return out;
}

bool measures_noise(const BeamSummary& beam) {
  constexpr double kSure = 0.8, kSteep_m = 0.15;
  constexpr std::size_t kLeastAnswers = 5;
  return beam.smooth && beam.answers >= kLeastAnswers && beam.share() > kSure && std::abs(beam.slope) < kSteep_m;
}

ScanTurns scan_turns(const StopBeams& stop, const std::function<double(double)>& range_variance,
                     double jitter_variance) {
  constexpr std::size_t kLeastBeams = 30;
  constexpr double kNear_m = 0.15;
  ScanTurns out;
  for (std::size_t k = 0; k < stop.stop.size(); ++k) {
    double sum = 0.0, weights = 0.0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < stop.beams.size(); ++i) {
      const BeamSummary& beam = stop.beams[i];
      const double off = stop.residual(k, i);
      if (!measures_noise(beam) || !(std::abs(off) < kNear_m)) continue;
      const double weight = 1.0 / (range_variance(beam.range) + beam.slope * beam.slope * jitter_variance);
      sum += weight * beam.slope * off;
      weights += weight * beam.slope * beam.slope;
      ++count;
    }
    const bool enough = count >= kLeastBeams && weights > 0.0;
    out.turns.push_back(enough ? sum / weights : std::numeric_limits<double>::quiet_NaN());
    out.variances.push_back(enough ? 1.0 / weights : std::numeric_limits<double>::quiet_NaN());
  }
  return out;
}

}  // namespace phasescan
