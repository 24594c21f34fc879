#include "io/csv_log.hpp"

#include <algorithm>
#include <cmath>
#include <deque>

#include "io/csv_columns.hpp"
#include "io/log_format.hpp"
#include "io/text_log.hpp"
#include "io/text_numbers.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kLookAheadRows = 2000;
constexpr std::size_t kLookAheadNumbers = 200'000;
constexpr std::size_t kMostBeams = 1'000'000;
constexpr double kAssumedScanSeconds = 0.1;
constexpr std::size_t kHeaderLines = 50;

/// The layout a line gives as a header, if it is one. "# angle distance quality" is.
std::optional<CsvLayout> layout_of_line(std::string_view line) {
  while (!line.empty() && (line.front() == '#' || line.front() == '%' || line.front() == ' ')) line.remove_prefix(1);
  std::vector<std::string_view> names;
  const char separator = guess_separator(line);
  split_fields(line, separator, names);
  return make_layout(names, separator);
}

bool is_comment(std::string_view line) {
  return line.empty() || line.front() == '#';
}

class CsvReader final : public TextLogReader {
 public:
  CsvReader(const std::string& path, const LogOptions& options) : TextLogReader(path) {
    if (!options.columns.empty()) {
      std::vector<std::string_view> names;
      split_fields(options.columns, ',', names);
      const auto layout = make_layout(names, ' ');
      if (!layout) {
        throw InputError("--columns", 0,
                         quote_text(options.columns) +
                             " names no ranges, or single ranges without angles; "
                             "expected for example angle_deg,range_mm or stamp,ranges");
      }
      layout_ = *layout;
      guess_separator_ = true;
    } else {
      find_header();
    }
    look_ahead();
  }

  std::string format() const override { return layout_.whole_scans ? "csv, a scan a line" : "csv, a beam a line"; }

  std::map<std::string, std::string> facts() const override {
    std::map<std::string, std::string> out;
    if (!assumed_.empty()) out["assumed units"] = assumed_;
    if (layout_.find(ColumnRole::kStamp) == nullptr) out["assumed stamps"] = "none in the file: 0.1 s a scan";
    if (layout_.whole_scans && layout_.find(ColumnRole::kAngleMin) == nullptr && !angles_stated()) {
      out["assumed angles"] = "none in the file: a full turn from 0, counter-clockwise";
    }
    return out;
  }

  std::optional<LogEntry> next() override {
    while (auto row = next_row()) {
      std::optional<LogEntry> entry = layout_.whole_scans ? whole_scan(*row) : add_beam(*row);
      if (entry) return entry;
    }
    return beams_.empty() ? std::nullopt : finish_beams();
  }

 private:
  struct Row {
    long line = 0;
    std::vector<double> numbers;
    std::optional<std::int64_t> stamp_integer;  ///< a stamp as it stands there: 19 digits do not fit into a double
    std::optional<Stamp> stamp_seconds;         ///< the same read as decimal seconds
  };
  struct Beam {
    double angle = 0.0;
    float range = 0.0F;
    float intensity = 0.0F;
  };

  void find_header() {
    std::string line;
    for (std::size_t i = 0; i < kHeaderLines && next_line(line); ++i) {
      if (const auto layout = layout_of_line(line)) {
        layout_ = *layout;
        guess_separator_ = is_comment(line);  // a header in a comment is for people
        return;
      }
    }
    throw InputError(path(), line_number(), "no header that names ranges; expected one, or --columns");
  }

  void look_ahead() {
    std::vector<std::vector<double>> rows;
    std::size_t numbers = 0;
    while (ahead_.size() < kLookAheadRows && numbers < kLookAheadNumbers) {
      std::optional<Row> row = parse_row();
      if (!row) break;
      numbers += row->numbers.size();
      rows.push_back(row->numbers);
      ahead_.push_back(std::move(*row));
    }
    assumed_ = settle_units(layout_, rows);
  }

  std::optional<Row> next_row() {
    if (ahead_.empty()) return parse_row();
    Row row = std::move(ahead_.front());
    ahead_.pop_front();
    return row;
  }

  /// The next line of numbers. Columns that nobody reads may hold anything; an empty range is a missing return.
  std::optional<Row> parse_row() {
    std::string line;
    while (next_line(line)) {
      if (is_comment(line)) continue;
      if (guess_separator_) layout_.separator = guess_separator(line), guess_separator_ = false;
      split_fields(line, layout_.separator, fields_);
      const bool open_end = layout_.columns.back().open_end;
      // A row of any length is whole where it ends; without an end, where it is as long as the one before.
      if (open_end && !line_was_ended() && fields_.size() != fields_before_) {
        damage_here("truncated line", "the file ends inside the line");
        continue;
      }
      fields_before_ = fields_.size();
      if (open_end ? fields_.size() < layout_.columns.size() : fields_.size() != layout_.columns.size()) {
        damage_here("wrong count",
                    std::to_string(fields_.size()) + " fields; expected " + std::to_string(layout_.columns.size()));
        continue;
      }
      Row row;
      row.line = line_number();
      if (parse_fields(row)) return row;
    }
    return std::nullopt;
  }

  bool parse_fields(Row& row) {
    row.numbers.reserve(fields_.size());
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      const ColumnRole role = column_at(i).role;
      std::optional<double> value = parse_number<double>(fields_[i]);
      if (!value && (role == ColumnRole::kIgnored || (role == ColumnRole::kRange && fields_[i].empty()))) value = 0.0;
      if (role == ColumnRole::kStamp) {
        row.stamp_integer = parse_number<std::int64_t>(fields_[i]);
        row.stamp_seconds = parse_stamp(fields_[i]);
      }
      if (!value) {
        damage_here("bad number",
                    "field " + std::to_string(i + 1) + " is " + quote_text(fields_[i]) + "; expected a number");
        return false;
      }
      row.numbers.push_back(*value);
    }
    return true;
  }

  const Column& column_at(std::size_t field) const {
    return layout_.columns[std::min(field, layout_.columns.size() - 1)];
  }

  /// A row's number of a role in SI units.
  std::optional<double> value(const std::vector<double>& numbers, ColumnRole role) const {
    const Column* column = layout_.find(role);
    if (column == nullptr) return std::nullopt;
    return numbers[static_cast<std::size_t>(column - layout_.columns.data())] * column->scale;
  }

  Stamp stamp_of(const Row& row) {
    const long scan = scans_++;
    const Column* column = layout_.find(ColumnRole::kStamp);
    if (column == nullptr) return stamp_from_seconds(static_cast<double>(scan) * kAssumedScanSeconds);
    if (column->scale == 1.0) return row.stamp_seconds.value_or(0);
    const auto ns = static_cast<std::int64_t>(std::llround(column->scale * 1e9));
    if (row.stamp_integer && std::abs(static_cast<double>(*row.stamp_integer)) * static_cast<double>(ns) < 9.2e18) {
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

  bool angles_stated() const { return layout_.find(ColumnRole::kAngleIncrement) != nullptr; }

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
      if (column.role == ColumnRole::kRange) ranges.push_back(static_cast<float>(row.numbers[i] * column.scale));
      if (column.role == ColumnRole::kIntensity) intensities.push_back(static_cast<float>(row.numbers[i]));
    }
    ScanGeometry geometry;
    geometry.angle_min = value(row.numbers, ColumnRole::kAngleMin).value_or(0.0);
    const auto n = static_cast<double>(ranges.size());
    const auto last = value(row.numbers, ColumnRole::kAngleMax);
    const double turn = last && n > 1 ? (*last - geometry.angle_min) / (n - 1) : 2.0 * kPi / n;
    geometry.angle_increment = value(row.numbers, ColumnRole::kAngleIncrement).value_or(turn);
    auto entry = make_entry(row, ranges, geometry, {});
    if (entry && intensities.size() == ranges.size()) entry->scan.intensities = std::move(intensities);
    return entry;
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
    const double angle = *value(row.numbers, ColumnRole::kAngle);
    if (!std::isfinite(angle)) {
      add_damage("bad number", path() + ":" + std::to_string(row.line) + ": the angle is not finite");
      return std::nullopt;
    }
    std::optional<LogEntry> entry;
    if (begins_scan(row.numbers, angle)) entry = finish_beams();
    if (beams_.empty()) first_ = row;
    beams_.push_back({angle, static_cast<float>(*value(row.numbers, ColumnRole::kRange)),
                      static_cast<float>(value(row.numbers, ColumnRole::kIntensity).value_or(0.0))});
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
    if (entry && layout_.find(ColumnRole::kIntensity) != nullptr) {
      for (const Beam& beam : beams_) entry->scan.intensities.push_back(beam.intensity);
    }
    beams_.clear();
    return entry;
  }

  CsvLayout layout_;
  bool guess_separator_ = false;
  std::string assumed_;
  std::vector<std::string_view> fields_;
  std::size_t fields_before_ = 0;
  std::deque<Row> ahead_;
  std::vector<Beam> beams_;
  Row first_;
  double direction_ = 0.0;
  long scans_ = 0;
};

}  // namespace

bool looks_like_csv(std::string_view prefix) {
  for (std::size_t i = 0; i < kHeaderLines && !prefix.empty(); ++i) {
    const std::size_t end = prefix.find('\n');
    std::string_view line = prefix.substr(0, end);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (layout_of_line(line)) return true;
    if (!is_comment(line)) return false;
    if (end == std::string_view::npos) return false;
    prefix.remove_prefix(end + 1);
  }
  return false;
}

LogFormat csv_format() {
  return {"CSV with a header (or --columns)",
          [](const std::string&, std::string_view prefix) { return looks_like_csv(prefix); }, open_csv};
}

std::unique_ptr<LogReader> open_csv(const std::string& path, const LogOptions& options) {
  return std::make_unique<CsvReader>(path, options);
}

}  // namespace phasescan
