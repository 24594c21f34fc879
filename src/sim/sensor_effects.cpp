#include "sim/sensor_effects.hpp"

#include <algorithm>
#include <string>

namespace phasescan {

template <>
std::span<const std::string_view> enum_names<sim::SectorLoss>() {
  static constexpr std::string_view names[] = {"empty", "closed", "held"};
  return names;
}

}  // namespace phasescan

namespace phasescan::sim {
namespace {

struct TableFields {
  std::string_view ranges_name, values_name;
  const Table& ranges;
  const Table& values;
  double value_max;
};

void check_table(std::string_view section, const TableFields& t) {
  const auto fail = [&](std::string_view field, const std::string& what) {
    throw std::invalid_argument(std::string(section) + "." + std::string(field) + ": " + what);
  };
  if (t.ranges.size() != t.values.size())
    fail(t.values_name, "has " + std::to_string(t.values.size()) + " values; expected as many as " +
                            std::string(t.ranges_name) + " (" + std::to_string(t.ranges.size()) + ")");
  constexpr std::size_t kMost = 10'000;
  if (t.ranges.size() > kMost) fail(t.ranges_name, "has more than " + std::to_string(kMost) + " values");
  constexpr double kRangeMax_m = 1000.0;
  double before = -1.0;
  for (const double range : t.ranges) {
    if (!(range >= 0.0 && range <= kRangeMax_m)) fail(t.ranges_name, "a value is outside 0..1000 m");
    if (range <= before) fail(t.ranges_name, "values must rise");
    before = range;
  }
  for (const double value : t.values) {
    if (!(value >= 0.0 && value <= t.value_max))
      fail(t.values_name, "a value is outside 0.." + std::to_string(t.value_max));
  }
}

}  // namespace

double table_value(std::span<const double> at, std::span<const double> values, double x) {
  const auto next = static_cast<std::size_t>(std::upper_bound(at.begin(), at.end(), x) - at.begin());
  if (next == 0) return values.front();
  if (next == at.size()) return values.back();
  const double share = (x - at[next - 1]) / (at[next] - at[next - 1]);
  return values[next - 1] + share * (values[next] - values[next - 1]);
}

void check_effects(std::string_view section, const SensorEffects& effects) {
  validate_options(section, effects);
  check_table(section,
              {"noise_ranges_m", "noise_sigmas_m", effects.noise_ranges_m, effects.noise_sigmas_m, /*value_max=*/10.0});
  check_table(section, {"dropout_ranges_m", "dropout_shares", effects.dropout_ranges_m, effects.dropout_shares,
                        /*value_max=*/1.0});
}

}  // namespace phasescan::sim
