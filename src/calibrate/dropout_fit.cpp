#include "calibrate/dropout_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "calibrate/noise_fit.hpp"

namespace phasescan {
namespace {

/// A beam of one stop: how often it was asked and answered.
struct Answers {
  double range = 0.0, asked = 0.0, answers = 0.0;
};

bool counts(const StopBeams& stop, const BeamSummary& beam) {
  constexpr std::size_t kLeastAsked = 5;
  const double flattest = std::tan(deg_to_rad(70.0)) * std::abs(stop.stop.step);
  return beam.smooth && beam.asked >= kLeastAsked && beam.answers > 0 && std::abs(beam.slope) < flattest * beam.range;
}

/// Consecutive losses of all beams, against what their number alone makes likely.
double fit_memory(std::span<const StopBeams> stops, double empty_share) {
  double more = 0.0, most = 0.0, scans = 0.0, by_chance = 0.0, in_all = 0.0;
  for (const StopBeams& stop : stops) {
    for (std::size_t i = 0; i < stop.beams.size(); ++i) {
      const BeamSummary& beam = stop.beams[i];
      if (!counts(stop, beam) || beam.asked != stop.stop.size()) continue;
      const auto n = static_cast<double>(beam.asked), lost = n - static_cast<double>(beam.answers);
      if (lost == 0.0) continue;
      double both = 0.0;
      for (std::size_t k = 1; k < stop.stop.size(); ++k)
        both += std::isnan(stop.stop.ranges[k - 1][i]) && std::isnan(stop.stop.ranges[k][i]) ? 1.0 : 0.0;
      const double spread = lost * (n - lost) / n;
      more += both - lost * (lost - 1.0) / n;
      most += spread;
      scans += spread * n;
      // Beams without a sample have no memory: what they add to the spread is taken out below.
      const double chance = std::clamp((lost / n - empty_share) / (1.0 - empty_share), 0.0, 1.0);
      by_chance += n * (1.0 - empty_share) * (1.0 - empty_share) * chance * (1.0 - chance);
      in_all += spread;
    }
  }
  constexpr double kLeast = 50.0;
  if (most < kLeast) return 0.0;
  const double diluted = empty_share > 0.0 ? std::clamp(by_chance / in_all, 0.1, 1.0) : 1.0;
  return std::clamp(memory_from_share(more / most, scans / most) / diluted, 0.0, 1.0);
}

/// Chance of a beam's answers on bad surface, where the share that is lost is anything from 0 to 1, and of none at all.
std::pair<double, double> bad_surface(double share, double n, double loss) {
  constexpr int kNodes = 40;
  double seen = 0.0, none = 0.0;
  for (int node = 0; node < kNodes; ++node) {
    const double answers = (1.0 - loss) * (node + 0.5) / kNodes;
    seen += std::exp(n * (share * std::log(answers) + (1.0 - share) * std::log(1.0 - answers))) / kNodes;
    none += std::pow(1.0 - answers, n) / kNodes;
  }
  return {seen, none};
}

/// Two kinds of beams, by expectation and maximisation: on good surface all lose the same share (by range), on bad
/// surface any share.
void fit_kinds(std::span<const Answers> beams, std::span<const std::size_t> bins, double memory, DropoutFit& fit) {
  constexpr int kRounds = 40;
  fit.losses.assign(bins.size() - 1, 0.05);
  double bad = 0.2;
  for (int round = 0; round < kRounds; ++round) {
    double bad_sum = 0.0, all = 0.0;
    for (std::size_t b = 0; b + 1 < bins.size(); ++b) {
      const double loss = std::clamp(fit.losses[b], 1e-4, 0.999);
      double lost = 0.0, asked = 0.0;
      for (std::size_t i = bins[b]; i < bins[b + 1]; ++i) {
        // Losses that last say less than as many independent ones.
        const double n = std::max(1.0, beams[i].asked * (1.0 - memory) / (1.0 + memory));
        const double share = beams[i].answers / beams[i].asked;
        const double good = std::exp(n * (share * std::log(1.0 - loss) + (1.0 - share) * std::log(loss)));
        const auto [bad_seen, bad_none] = bad_surface(share, n, loss);
        const double is_bad = bad * bad_seen / (bad * bad_seen + (1.0 - bad) * good);
        lost += (1.0 - is_bad) * (1.0 - share) * beams[i].asked;
        asked += (1.0 - is_bad) * beams[i].asked;
        // Bad surface that never answered was never seen: each one seen stands for more.
        const double stands_for = 1.0 / (1.0 - bad_none);
        bad_sum += is_bad * stands_for;
        all += is_bad * stands_for + (1.0 - is_bad) / (1.0 - std::pow(loss, n));
      }
      if (asked > 0.0) fit.losses[b] = lost / asked;
    }
    bad = std::clamp(bad_sum / all, 1e-6, 0.999);
  }
  fit.patch_share = bad;
}

}  // namespace

double memory_from_share(double seen, double scans) {
  const auto expected = [&](double m) {
    double all = scans;  // sum of m^|i - j| over all pairs of scans
    for (double gap = 1.0; gap < scans; gap += 1.0) all += 2.0 * (scans - gap) * std::pow(m, gap);
    return (1.0 + (scans - 1.0) * m - all / scans) / (scans - all / scans);
  };
  double low = 0.0, high = 0.999;
  if (seen <= expected(low)) return low;
  if (seen >= expected(high)) return high;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (expected(middle) < seen ? low : high) = middle;
  }
  return low;
}

DropoutFit fit_dropout(std::span<const StopBeams> stops, double empty_share) {
  constexpr std::size_t kLeastBeams = 60;
  std::vector<Answers> beams;
  for (const StopBeams& stop : stops) {
    for (const BeamSummary& beam : stop.beams) {
      if (counts(stop, beam))
        beams.push_back({beam.range, static_cast<double>(beam.asked), static_cast<double>(beam.answers)});
    }
  }
  std::sort(beams.begin(), beams.end(), [](const Answers& a, const Answers& b) { return a.range < b.range; });
  DropoutFit fit;
  fit.beams = beams.size();
  if (beams.size() < kLeastBeams) return fit;
  std::vector<double> ranges;
  for (const Answers& beam : beams) ranges.push_back(beam.range);
  const std::vector<std::size_t> bins = range_bins(ranges, kLeastBeams);
  fit.memory = fit_memory(stops, empty_share);
  fit_kinds(beams, bins, fit.memory, fit);
  for (std::size_t b = 0; b + 1 < bins.size(); ++b) {
    double sum = 0.0;
    for (std::size_t i = bins[b]; i < bins[b + 1]; ++i) sum += ranges[i];
    fit.ranges.push_back(sum / static_cast<double>(bins[b + 1] - bins[b]));
    fit.losses[b] = std::max(0.0, 1.0 - (1.0 - fit.losses[b]) / (1.0 - empty_share));
  }
  return fit;
}

}  // namespace phasescan
