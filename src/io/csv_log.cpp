#include "io/csv_log.hpp"

#include <algorithm>
#include <cmath>

#include "io/beam_geometry.hpp"
#include "io/csv_rows.hpp"
#include "io/log_format.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kMostBeams = 1'000'000;
constexpr double kAssumedScanSeconds = 0.1;

class CsvReader final : public CsvRowReader {
 public:
  CsvReader(LogInput& input, const LogOptions& options) : CsvRowReader(input, options), beams_option_(options.beams) {}

  std::string format() const override { return layout().whole_scans ? "csv, a scan a line" : "csv, a beam a line"; }

  std::map<std::string, std::string> facts() const override {
    std::map<std::string, std::string> out;
    if (!assumed().empty()) out["assumed units"] = assumed();
    if (!stamps_stated()) out["assumed stamps"] = "none in the file: 0.1 s a scan";
    if (by_flags() && !assumed_of(beams_option_).empty())
      out["assumed angles"] = "none in the file: " + assumed_of(beams_option_);
    return out;
  }

  std::vector<LogRemark> remarks() const override {
    std::vector<LogRemark> out;
    if (by_flags() && !assumed_of(beams_option_).empty()) {
      out.push_back({"assumed angles", "the file states no angles: taken as " + assumed_of(beams_option_) +
                                           "; --fov, --angle-min, --angle-increment and --clockwise say otherwise"});
    }
    const Column* angle = layout().find(ColumnRole::kAngle);
    if (!layout().whole_scans && angle != nullptr && !angle->clockwise) {
      out.push_back({"assumed direction",
                     "angles are taken as counter-clockwise; for a sensor that turns clockwise (RPLidar, LD06): "
                     "--clockwise, or a column angle_deg_cw"});
    }
    if (is_lone_line()) {
      out.push_back({"assumed end",
                     "the only line does not end: if the file was cut off, beams at the end of the scan "
                     "are missing"});
    }
    if (!stamps_stated()) out.push_back({"assumed stamps", "the file states no times: 0.1 s a scan is assumed"});
    return out;
  }

  std::optional<LogEntry> next() override {
    while (auto row = next_row()) {
      std::optional<LogEntry> entry = layout().whole_scans ? whole_scan(*row) : add_beam(*row);
      if (entry) return entry;
    }
    return beams_.empty() ? std::nullopt : finish_beams();
  }

 private:
  struct Beam {
    double angle = 0.0;
    float range = 0.0F;
    float intensity = 0.0F;
  };

  Stamp stamp_of(const Row& row) {
    const long scan = scans_++;
    if (row.clock) return *row.clock;
    const auto seconds = value(row.numbers, ColumnRole::kStampSeconds);
    const auto rest = value(row.numbers, ColumnRole::kStampNanoseconds);
    if (seconds && std::abs(*seconds) < kMostStampSeconds)
      return stamp_from_seconds(*seconds) + static_cast<Stamp>(std::clamp(rest.value_or(0.0), 0.0, 999'999'999.0));
    const Column* column = layout().find(ColumnRole::kStamp);
    if (column == nullptr) return stamp_from_seconds(static_cast<double>(scan) * kAssumedScanSeconds);
    if (column->scale == 1.0) return row.stamp_seconds.value_or(0);
    const auto ns = static_cast<std::int64_t>(std::llround(column->scale * 1e9));
    if (row.stamp_integer &&
        std::abs(static_cast<double>(*row.stamp_integer)) * static_cast<double>(ns) < 1e9 * kMostStampSeconds) {
      return *row.stamp_integer * ns;
    }
    return stamp_from_seconds(*value(row.numbers, ColumnRole::kStamp));
  }

  void add_odometry(const std::vector<double>& numbers, LogEntry& entry) const {
    const auto x = value(numbers, ColumnRole::kOdomX);
    const auto y = value(numbers, ColumnRole::kOdomY);
    const auto theta = value(numbers, ColumnRole::kOdomTheta);
    if (!x || !y || !theta) return;
    const Pose2 pose{*x, *y, wrap_angle(*theta)};
    if (pose.is_finite()) entry.odometry = pose;
  }

  bool stamps_stated() const {
    return layout().find(ColumnRole::kStamp) != nullptr || layout().find(ColumnRole::kStampSeconds) != nullptr;
  }
  /// No column says where the beams of a whole scan lie.
  bool by_flags() const {
    return layout().whole_scans && layout().find(ColumnRole::kAngleMin) == nullptr &&
           layout().find(ColumnRole::kAngleIncrement) == nullptr && layout().find(ColumnRole::kAngleMax) == nullptr;
  }

  /// A range as a beam: what no sensor can see is no range.
  static float range_of(double metres) {
    constexpr double kFarthest = 1e5;
    return metres > kFarthest && std::isfinite(metres) ? std::nanf("") : static_cast<float>(metres);
  }

  /// Fills in limits and odometry and builds the scan; nothing where it cannot be one.
  std::optional<LogEntry> make_entry(const Row& row, std::span<const float> raw, ScanGeometry geometry,
                                     std::span<const float> angles) {
    const std::vector<double>& numbers = row.numbers;
    geometry.range_min = value(numbers, ColumnRole::kRangeMin).value_or(0.0);
    geometry.range_max = value(numbers, ColumnRole::kRangeMax).value_or(0.0);
    LogEntry entry;
    try {
      entry.scan = make_scan(raw, geometry, angles);
    } catch (const std::invalid_argument& error) {
      add_damage("bad scan", path() + ":" + std::to_string(row.line) + ": " + error.what());
      return std::nullopt;
    }
    entry.line = row.line;
    entry.scan.stamp = stamp_of(row);
    entry.scan.time_increment = std::clamp(value(numbers, ColumnRole::kTimeIncrement).value_or(0.0), 0.0, 1.0);
    add_odometry(numbers, entry);
    return entry;
  }

  std::optional<LogEntry> whole_scan(const Row& row) {
    std::vector<float> ranges;
    std::vector<float> intensities;
    for (std::size_t i = 0; i < row.numbers.size(); ++i) {
      const Column& column = column_at(i);
      if (row.arrays && !column.indexed) continue;
      if (column.role == ColumnRole::kRange) ranges.push_back(range_of(row.numbers[i] * column.scale));
      if (column.role == ColumnRole::kIntensity) intensities.push_back(finite_or_zero(row.numbers[i]));
    }
    const Column* column = layout().find(ColumnRole::kRange);
    for (const double range : row.ranges) ranges.push_back(range_of(range * column->scale));
    for (const double intensity : row.intensities) intensities.push_back(finite_or_zero(intensity));
    const auto geometry = geometry_of(row, ranges.size());
    if (!geometry) return std::nullopt;
    auto entry = make_entry(row, ranges, *geometry, {});
    if (entry && intensities.size() == ranges.size()) entry->scan.intensities = std::move(intensities);
    return entry;
  }

  static float finite_or_zero(double value) { return std::isfinite(value) ? static_cast<float>(value) : 0.0F; }

  /// Of a whole scan: as the columns say, else as the flags do. Nothing, and damage, where they contradict each other.
  std::optional<ScanGeometry> geometry_of(const Row& row, std::size_t beams) {
    ScanGeometry geometry;
    const auto n = static_cast<double>(beams);
    const auto last = value(row.numbers, ColumnRole::kAngleMax);
    if (by_flags()) {
      try {
        const BeamFan fan = fan_of(beams_option_, beams);
        geometry.angle_min = fan.angle_min;
        geometry.angle_increment = fan.angle_increment;
      } catch (const std::invalid_argument& error) {
        if (scans_ == 0) throw InputError(path(), row.line, error.what());
        add_damage("wrong count", path() + ":" + std::to_string(row.line) + ": " + error.what());
        return std::nullopt;
      }
      return geometry;
    }
    geometry.angle_min = value(row.numbers, ColumnRole::kAngleMin).value_or(0.0);
    const double turn = last && n > 1 ? (*last - geometry.angle_min) / (n - 1) : 2.0 * kPi / n;
    geometry.angle_increment = value(row.numbers, ColumnRole::kAngleIncrement).value_or(turn);
    return geometry;
  }

  /// A turn ends where its number changes, at a start mark, or where the angle jumps back.
  bool begins_scan(const std::vector<double>& numbers, double angle) {
    if (beams_.empty()) return false;
    if (beams_.size() >= kMostBeams) return true;
    if (const auto number = value(numbers, ColumnRole::kScanNumber))
      return *number != value(first_.numbers, ColumnRole::kScanNumber);
    if (const auto start = value(numbers, ColumnRole::kScanStart)) return *start == 1.0;
    const double step = angle - beams_.back().angle;
    const double span = std::abs(beams_.back().angle - beams_.front().angle);
    if (direction_ == 0.0) direction_ = step > 0.0 ? 1.0 : step < 0.0 ? -1.0 : 0.0;
    return step * direction_ < 0.0 && std::abs(step) > std::max(0.1, span / 2.0);
  }

  std::optional<LogEntry> add_beam(const Row& row) {
    const auto x = value(row.numbers, ColumnRole::kPointX), y = value(row.numbers, ColumnRole::kPointY);
    const bool is_point = layout().find(ColumnRole::kAngle) == nullptr;
    const double angle = is_point ? std::atan2(*y, *x) : *value(row.numbers, ColumnRole::kAngle);
    const double range = is_point ? std::hypot(*x, *y) : *value(row.numbers, ColumnRole::kRange);
    if (!std::isfinite(angle)) {
      add_damage("bad number", path() + ":" + std::to_string(row.line) + ": the angle is not finite");
      return std::nullopt;
    }
    std::optional<LogEntry> entry;
    if (begins_scan(row.numbers, angle)) entry = finish_beams();
    if (beams_.empty()) first_ = row;
    beams_.push_back(
        {angle, range_of(range), finite_or_zero(value(row.numbers, ColumnRole::kIntensity).value_or(0.0))});
    return entry;
  }

  std::optional<LogEntry> finish_beams() {
    std::vector<float> ranges;
    std::vector<float> angles;
    for (const Beam& beam : beams_) {
      ranges.push_back(beam.range);
      angles.push_back(static_cast<float>(beam.angle));
    }
    auto entry = make_entry(first_, ranges, {}, angles);
    if (entry && layout().find(ColumnRole::kIntensity) != nullptr) {
      for (const Beam& beam : beams_) entry->scan.intensities.push_back(beam.intensity);
    }
    beams_.clear();
    return entry;
  }

  BeamGeometry beams_option_;
  std::vector<Beam> beams_;
  Row first_;
  double direction_ = 0.0;
  long scans_ = 0;
};

}  // namespace

LogFormat csv_format() {
  return {"CSV with a header (or --columns)", [](const LogInput& input) { return looks_like_csv(input.prefix()); },
          open_csv};
}

std::unique_ptr<LogReader> open_csv(LogInput& input, const LogOptions& options) {
  return std::make_unique<CsvReader>(input, options);
}

}  // namespace phasescan
