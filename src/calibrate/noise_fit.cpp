#include "calibrate/noise_fit.hpp"

#include <algorithm>
#include <cmath>

#include "sim/sensor_effects.hpp"

namespace phasescan {
namespace {

/// How far the ranges of one beam of one stop scatter.
struct BeamSpread {
  double range = 0.0, slope2 = 0.0;
  double variance = 0.0, freedom = 0.0;
};

constexpr double kLeastVariance = 1e-10;  // (0.01 mm)^2: a curve of exactly nothing would have infinite weight

std::vector<BeamSpread> beam_spreads(const StopBeams& stop, const ScanTurns& turns) {
  std::vector<BeamSpread> out;
  for (std::size_t i = 0; i < stop.beams.size(); ++i) {
    const BeamSummary& beam = stop.beams[i];
    if (!measures_noise(beam)) continue;
    double sum = 0.0, sum2 = 0.0, n = 0.0;
    for (std::size_t k = 0; k < stop.stop.size(); ++k) {
      double off = stop.residual(k, i);
      if (!(std::abs(off) < kSameSurface_m)) continue;
      if (!std::isnan(turns.turns[k])) off -= turns.turns[k] * beam.slope;
      sum += off;
      sum2 += off * off;
      n += 1.0;
    }
    if (n < 5.0) continue;
    out.push_back({beam.range, beam.slope2, std::max(0.0, (sum2 - sum * sum / n) / (n - 1.0)), n - 1.0});
  }
  std::sort(out.begin(), out.end(), [](const BeamSpread& a, const BeamSpread& b) { return a.range < b.range; });
  return out;
}

/// One curve value a bin and one jitter for all, by least squares; spreads far above what is expected count less, as a
/// few beams of every stop see two surfaces or somebody's leg.
void fit_curve(std::span<const BeamSpread> spreads, std::span<const std::size_t> bins, NoiseFit& fit) {
  constexpr int kRounds = 60;
  constexpr double kFar = 2.0;
  std::vector<double> variances(bins.size() - 1, 1e-4);
  double jitter = 0.06;
  for (int round = 0; round < kRounds; ++round) {
    double jitter_sum = 0.0, jitter_weight = 0.0;
    std::vector<double> next(variances.size());
    for (std::size_t b = 0; b + 1 < bins.size(); ++b) {
      double sum = 0.0, weight = 0.0;
      for (std::size_t i = bins[b]; i < bins[b + 1]; ++i) {
        const BeamSpread& s = spreads[i];
        const double expected = variances[b] + s.slope2 * jitter;
        const double w =
            s.freedom / (expected * expected) * std::min(1.0, kFar * expected / std::max(s.variance, 1e-15));
        sum += w * (s.variance - s.slope2 * jitter);
        weight += w;
        jitter_sum += w * s.slope2 * (s.variance - variances[b]);
        jitter_weight += w * s.slope2 * s.slope2;
      }
      next[b] = std::max(kLeastVariance, sum / weight);
    }
    variances = next;
    if (jitter_weight > 0.0) jitter = std::max(0.0, jitter_sum / jitter_weight);
  }
  fit.variances = variances;
  fit.jitter_variance = jitter;
  fit.ranges.clear();
  for (std::size_t b = 0; b + 1 < bins.size(); ++b) {
    double sum = 0.0;
    for (std::size_t i = bins[b]; i < bins[b + 1]; ++i) sum += spreads[i].range;
    fit.ranges.push_back(sum / static_cast<double>(bins[b + 1] - bins[b]));
  }
}

/// Variance of the turns within stops, without what the estimate itself scatters by.
void fit_turn(std::span<const ScanTurns> all, NoiseFit& fit) {
  double squares = 0.0, freedom = 0.0, own = 0.0, count = 0.0;
  for (const ScanTurns& stop : all) {
    double sum = 0.0, sum2 = 0.0, n = 0.0;
    for (std::size_t k = 0; k < stop.turns.size(); ++k) {
      if (std::isnan(stop.turns[k])) continue;
      sum += stop.turns[k];
      sum2 += stop.turns[k] * stop.turns[k];
      own += stop.variances[k];
      n += 1.0;
    }
    count += n;
    if (n < 2.0) continue;
    squares += sum2 - sum * sum / n;
    freedom += n - 1.0;
  }
  fit.turns = static_cast<std::size_t>(count);
  if (freedom <= 0.0) return;
  // What is left must be more than chance makes of so many turns.
  const double seen = squares / freedom, left = seen - own / count;
  fit.turn_variance = left > 2.0 * seen * std::sqrt(2.0 / freedom) ? left : 0.0;
}

/// Correlation of the direction errors of beams some steps apart, for 1 to kLags steps.
struct Correlation {
  static constexpr std::size_t kLags = 12;
  std::vector<double> at = std::vector<double>(kLags + 1, 0.0), weight = std::vector<double>(kLags + 1, 0.0);
};

Correlation jitter_correlation(std::span<const StopBeams> stops, std::span<const ScanTurns> turns,
                               const NoiseFit& fit) {
  constexpr double kSteep_m = 0.01, kFar_steps = 1.0;
  Correlation out;
  for (std::size_t s = 0; s < stops.size(); ++s) {
    const StopBeams& stop = stops[s];
    const std::size_t n = stop.beams.size();
    std::vector<double> errors(n), weights(n);
    for (std::size_t k = 0; k < stop.stop.size(); ++k) {
      if (std::isnan(turns[s].turns[k])) continue;
      for (std::size_t i = 0; i < n; ++i) {
        const BeamSummary& beam = stop.beams[i];
        weights[i] = 0.0;
        const double slope2 = beam.slope * beam.slope;
        if (!measures_noise(beam) || std::abs(beam.slope) < kSteep_m ||
            fit.range_variance(beam.range) > 0.5 * slope2 * fit.jitter_variance)
          continue;
        errors[i] = stop.residual(k, i) / beam.slope - turns[s].turns[k];
        weights[i] = std::abs(errors[i]) < kFar_steps ? 1.0 : 0.0;
      }
      for (std::size_t lag = 1; lag <= Correlation::kLags; ++lag) {
        for (std::size_t i = 0; i + lag < n; ++i) {
          if (weights[i] == 0.0 || weights[i + lag] == 0.0) continue;
          out.at[lag] += errors[i] * errors[i + lag];
          out.weight[lag] += 1.0;
        }
      }
    }
  }
  for (std::size_t lag = 1; lag <= Correlation::kLags; ++lag) {
    if (out.weight[lag] > 0.0 && fit.jitter_variance > 0.0) out.at[lag] /= out.weight[lag] * fit.jitter_variance;
  }
  return out;
}

/// Samples that are not in step with the beams: the error grows from beam to beam and jumps back, uniform within half a
/// step, so its correlation after a share u of the period is 1 - 6 u + 6 u^2.
JitterPattern jitter_pattern(const Correlation& correlation, double jitter_variance) {
  constexpr double kLeastPairs = 200.0, kUniform = 1.0 / 12.0;
  JitterPattern out;
  if (correlation.weight[1] < kLeastPairs) return out;
  out.neighbour_correlation = correlation.at[1];
  if (out.neighbour_correlation < 0.35 || jitter_variance < 0.5 * kUniform || jitter_variance > 1.7 * kUniform)
    return out;
  double best = 0.0;
  for (std::size_t lag = 1; lag <= Correlation::kLags; ++lag)
    best += correlation.weight[lag] * correlation.at[lag] * correlation.at[lag];
  best *= 0.5;  // a sawtooth must explain half of what no correlation at all leaves
  for (double period = 4.0; period < 400.0; period *= 1.01) {
    double rest = 0.0;
    for (std::size_t lag = 1; lag <= Correlation::kLags; ++lag) {
      const double u = std::fmod(static_cast<double>(lag), period) / period;
      rest += correlation.weight[lag] * std::pow(correlation.at[lag] - (1.0 - 6.0 * u + 6.0 * u * u), 2);
    }
    if (rest < best) {
      best = rest;
      out.period = period;
    }
  }
  return out;
}

}  // namespace

double NoiseFit::range_variance(double range) const {
  if (ranges.empty()) return std::pow(0.005 + 0.005 * range, 2);
  return sim::table_value(ranges, variances, range);
}

std::vector<std::size_t> range_bins(std::span<const double> sorted_ranges, std::size_t least) {
  constexpr double kApart = 1.33;
  std::vector<std::size_t> borders{0};
  for (std::size_t i = 1; i < sorted_ranges.size(); ++i) {
    const bool wide = sorted_ranges[i] > kApart * sorted_ranges[borders.back()];
    if (wide && i - borders.back() >= least && sorted_ranges.size() - i >= least) borders.push_back(i);
  }
  borders.push_back(sorted_ranges.size());
  return borders;
}

std::optional<NoiseFit> fit_noise(std::span<const StopBeams> stops) {
  constexpr std::size_t kLeastBeams = 40;
  constexpr int kRounds = 3;
  NoiseFit fit;
  fit.jitter_variance = 0.06;
  std::vector<ScanTurns> turns(stops.size());
  for (int round = 0; round < kRounds; ++round) {
    std::vector<BeamSpread> spreads;
    for (std::size_t s = 0; s < stops.size(); ++s) {
      turns[s] = scan_turns(
          stops[s], [&](double r) { return fit.range_variance(r); }, fit.jitter_variance);
      const auto more = beam_spreads(stops[s], turns[s]);
      spreads.insert(spreads.end(), more.begin(), more.end());
    }
    if (spreads.size() < kLeastBeams) return {};
    std::sort(spreads.begin(), spreads.end(), [](const auto& a, const auto& b) { return a.range < b.range; });
    std::vector<double> ranges;
    for (const BeamSpread& spread : spreads) ranges.push_back(spread.range);
    fit_curve(spreads, range_bins(ranges, kLeastBeams), fit);
    fit.beams = spreads.size();
  }
  fit_turn(turns, fit);
  fit.pattern = jitter_pattern(jitter_correlation(stops, turns, fit), fit.jitter_variance);
  return fit;
}

}  // namespace phasescan
