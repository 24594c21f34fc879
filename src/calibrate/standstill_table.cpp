#include "calibrate/standstill_table.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace phasescan {
namespace {

struct Spread {
  double range = 0.0, sigma = 0.0, slope = 0.0;
};

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const double at = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (at - static_cast<double>(below)) * (values[above] - values[below]);
}

/// All scans count here, those with a lost sector too: nothing is fitted.
double share_of_all(const StopBeams& stop, std::size_t beam) {
  std::size_t answers = 0;
  for (const auto& scan : stop.stop.ranges) answers += std::isnan(scan[beam]) ? 0 : 1;
  return static_cast<double>(answers) / static_cast<double>(stop.stop.size());
}

bool is_used(const StopBeams& stop, std::size_t beam, double share) {
  const BeamSummary& b = stop.beams[beam];
  return share > 0.8 && b.smooth && std::abs(b.slope) < 0.15;
}

void add_spreads(const StopBeams& stop, std::vector<Spread>& spreads, std::vector<double>& shares) {
  for (std::size_t i = 0; i < stop.beams.size(); ++i) {
    const double share = share_of_all(stop, i);
    if (share > 0.05) shares.push_back(share);
    if (!is_used(stop, i, share)) continue;
    double sum = 0.0, sum2 = 0.0, n = 0.0;
    for (std::size_t k = 0; k < stop.stop.size(); ++k) {
      const double off = stop.residual(k, i);
      if (!(std::abs(off) < kSameSurface_m)) continue;
      sum += off;
      sum2 += off * off;
      n += 1.0;
    }
    if (n > 0.0)
      spreads.push_back({stop.beams[i].range, std::sqrt(std::max(0.0, sum2 / n - sum * sum / (n * n))),
                         std::abs(stop.beams[i].slope)});
  }
}

}  // namespace

StandstillTable standstill_table(std::span<const StopBeams> stops) {
  StandstillTable table;
  std::vector<Spread> spreads;
  std::vector<double> shares, turns;
  for (const StopBeams& stop : stops) {
    add_spreads(stop, spreads, shares);
    const ScanTurns all = scan_turns(
        stop, [](double) { return 1.0; }, 0.0);
    std::copy_if(all.turns.begin(), all.turns.end(), std::back_inserter(turns),
                 [](double t) { return !std::isnan(t); });
  }
  constexpr double kBorders[] = {0.2, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 9.0, 13.0, 20.0, 30.0, 50.0};
  constexpr std::size_t kLeast = 20;
  for (std::size_t b = 0; b + 1 < std::size(kBorders); ++b) {
    std::vector<double> all, steep;
    for (const Spread& s : spreads) {
      if (s.range < kBorders[b] || s.range >= kBorders[b + 1]) continue;
      all.push_back(s.sigma);
      if (s.slope > 0.02) steep.push_back(s.sigma);
    }
    if (all.size() < kLeast) continue;
    table.rows.push_back(
        {kBorders[b], kBorders[b + 1], all.size(), quantile(all, 0.5), quantile(all, 0.9), quantile(steep, 0.5)});
  }
  double sum = 0.0, sum2 = 0.0;
  for (const double turn : turns) {
    sum += turn;
    sum2 += turn * turn;
  }
  const auto n = static_cast<double>(std::max<std::size_t>(1, turns.size()));
  table.turn_steps = std::sqrt(std::max(0.0, sum2 / n - sum * sum / (n * n)));
  table.turns = turns.size();
  for (const double share : shares) {
    table.present += share / static_cast<double>(shares.size());
    table.come_and_go += (share < 0.95 ? 1.0 : 0.0) / static_cast<double>(shares.size());
  }
  return table;
}

}  // namespace phasescan
