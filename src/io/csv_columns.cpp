#include "io/csv_columns.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "io/file.hpp"
#include "phasescan/core/pose2.hpp"
#include "phasescan/io/error.hpp"

namespace phasescan {
namespace {

struct Name {
  std::string_view name;
  ColumnRole role;
};

constexpr Name kNames[] = {
    {"stamp", ColumnRole::kStamp},
    {"time", ColumnRole::kStamp},
    {"timestamp", ColumnRole::kStamp},
    {"t", ColumnRole::kStamp},
    {"header.stamp", ColumnRole::kStamp},
    {"header.stamp.secs", ColumnRole::kStampSeconds},
    {"header.stamp.sec", ColumnRole::kStampSeconds},
    {"secs", ColumnRole::kStampSeconds},
    {"header.stamp.nsecs", ColumnRole::kStampNanoseconds},
    {"header.stamp.nanosec", ColumnRole::kStampNanoseconds},
    {"nsecs", ColumnRole::kStampNanoseconds},
    {"nanosec", ColumnRole::kStampNanoseconds},
    {"angle", ColumnRole::kAngle},
    {"theta", ColumnRole::kAngle},
    {"bearing", ColumnRole::kAngle},
    {"azimuth", ColumnRole::kAngle},
    {"angule", ColumnRole::kAngle},
    {"range", ColumnRole::kRange},
    {"ranges", ColumnRole::kRange},
    {"distance", ColumnRole::kRange},
    {"distances", ColumnRole::kRange},
    {"dist", ColumnRole::kRange},
    {"r", ColumnRole::kRange},
    {"intensity", ColumnRole::kIntensity},
    {"intensities", ColumnRole::kIntensity},
    {"quality", ColumnRole::kIntensity},
    {"q", ColumnRole::kIntensity},
    {"signal", ColumnRole::kIntensity},
    {"scan", ColumnRole::kScanNumber},
    {"scan_id", ColumnRole::kScanNumber},
    {"scan_number", ColumnRole::kScanNumber},
    {"revolution", ColumnRole::kScanNumber},
    {"frame", ColumnRole::kScanNumber},
    {"start", ColumnRole::kScanStart},
    {"start_flag", ColumnRole::kScanStart},
    {"sync", ColumnRole::kScanStart},
    {"new_scan", ColumnRole::kScanStart},
    {"angle_min", ColumnRole::kAngleMin},
    {"angle_increment", ColumnRole::kAngleIncrement},
    {"angle_max", ColumnRole::kAngleMax},
    {"range_min", ColumnRole::kRangeMin},
    {"range_max", ColumnRole::kRangeMax},
    {"time_increment", ColumnRole::kTimeIncrement},
    {"odom_x", ColumnRole::kOdomX},
    {"odom_y", ColumnRole::kOdomY},
    {"odom_theta", ColumnRole::kOdomTheta},
    {"odom_yaw", ColumnRole::kOdomTheta},
    {"x", ColumnRole::kPointX},
    {"y", ColumnRole::kPointY},
};

struct Unit {
  std::string_view suffix;
  double scale;
};

constexpr Unit kUnits[] = {{"deg", kPi / 180.0}, {"rad", 1.0}, {"mm", 1e-3}, {"cm", 1e-2}, {"m", 1.0},
                           {"ns", 1e-9},         {"us", 1e-6}, {"ms", 1e-3}, {"s", 1.0},   {"sec", 1.0}};

ColumnRole role_of(std::string_view name) {
  const auto* found = std::find_if(std::begin(kNames), std::end(kNames), [&](const Name& n) { return n.name == name; });
  return found == std::end(kNames) ? ColumnRole::kIgnored : found->role;
}

bool cut_suffix(std::string& name, std::string_view suffix) {
  if (name.size() <= suffix.size() + 1 || !name.ends_with(suffix) || name[name.size() - suffix.size() - 1] != '_')
    return false;
  name.resize(name.size() - suffix.size() - 1);
  return true;
}

/// Lower case; brackets and blanks become one '_' each run; quotes and % go.
std::string normalised(std::string_view name) {
  std::string out;
  for (const char c : name) {
    if (c == '"' || c == '\'' || c == '%' || c == '#') continue;
    const bool gap = c == ' ' || c == '[' || c == ']' || c == '(' || c == ')' || c == '/' || c == '_' || c == '-';
    if (!gap) {
      out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    } else if (!out.empty() && out.back() != '_') {
      out += '_';
    }
  }
  while (!out.empty() && out.back() == '_') out.pop_back();
  if (out.starts_with('.')) out.erase(0, 1);
  for (const std::string_view prefix : {"field.", "msg."}) {
    if (out.starts_with(prefix)) out.erase(0, prefix.size());
  }
  return out;
}

}  // namespace

Column parse_column(std::string_view raw) {
  std::string name = normalised(raw);
  Column column;
  column.scale = 0.0;
  // rostopic echo -p: nanoseconds, whatever their size; a simulation's clock begins at 0.
  const bool rostopic_header = name == "header.stamp" && raw.find("field.") != std::string_view::npos;
  if (rostopic_header || (name == "time" && raw.find('%') != std::string_view::npos)) column.scale = 1e-9;
  column.from_header = name.starts_with("header.stamp");
  column.clockwise = cut_suffix(name, "cw");
  for (const Unit& unit : kUnits) {
    if (column.scale == 0.0 && cut_suffix(name, unit.suffix)) column.scale = unit.scale;
  }
  column.role = role_of(name);
  if (column.role == ColumnRole::kIgnored) {
    const auto digits = name.find_last_not_of("0123456789");
    if (digits != std::string::npos && digits + 1 < name.size()) {
      name.resize(digits + 1);
      while (!name.empty() && name.back() == '_') name.pop_back();
      column.role = role_of(name);
      column.indexed = column.role == ColumnRole::kRange || column.role == ColumnRole::kIntensity;
      if (!column.indexed) column.role = ColumnRole::kIgnored;
    }
  } else if (name == "ranges" || name == "distances") {
    column.open_end = true;
  }
  return column;
}

const Column* CsvLayout::find(ColumnRole role) const {
  const auto found = std::find_if(columns.begin(), columns.end(), [role](const Column& c) { return c.role == role; });
  return found == columns.end() ? nullptr : &*found;
}

/// Where a tool writes when it received a message and when it was measured, the latter counts.
static void prefer_header_stamp(CsvLayout& layout) {
  const auto is_header = [](const Column& c) {
    return c.from_header && (c.role == ColumnRole::kStamp || c.role == ColumnRole::kStampSeconds);
  };
  if (std::none_of(layout.columns.begin(), layout.columns.end(), is_header)) return;
  for (Column& column : layout.columns) {
    if (column.role == ColumnRole::kStamp && !column.from_header) column.role = ColumnRole::kIgnored;
  }
}

std::optional<CsvLayout> make_layout(const std::vector<std::string_view>& names, char separator) {
  CsvLayout layout;
  layout.separator = separator;
  std::size_t ranges = 0;
  for (const std::string_view name : names) {
    layout.columns.push_back(parse_column(name));
    const Column& column = layout.columns.back();
    if (column.role == ColumnRole::kRange) {
      ++ranges;
      layout.whole_scans = layout.whole_scans || column.indexed || column.open_end;
    }
  }
  if (ranges == 0 && (layout.find(ColumnRole::kPointX) == nullptr || layout.find(ColumnRole::kPointY) == nullptr))
    return std::nullopt;
  if (!layout.whole_scans && ranges > 0 && (ranges > 1 || layout.find(ColumnRole::kAngle) == nullptr))
    return std::nullopt;
  prefer_header_stamp(layout);
  return layout;
}

char guess_separator(std::string_view line) {
  for (const char separator : {',', ';', '\t'}) {
    if (line.find(separator) != std::string_view::npos) return separator;
  }
  return ' ';
}

namespace {

/// The size below which a share of a column's values lies, zeros left out; no single damaged or wild value moves it.
/// Columns of ranges count as one.
double usual_size(const CsvLayout& layout, std::size_t index, const std::vector<std::vector<double>>& rows,
                  double share) {
  const ColumnRole role = layout.columns[index].role;
  std::vector<double> sizes;
  for (const auto& row : rows) {
    for (std::size_t k = 0; k < row.size(); ++k) {
      const std::size_t at = std::min(k, layout.columns.size() - 1);
      const bool counts = role == ColumnRole::kRange ? layout.columns[at].role == role : at == index;
      if (counts && std::isfinite(row[k]) && row[k] != 0.0) sizes.push_back(std::abs(row[k]));
    }
  }
  if (sizes.empty()) return 0.0;
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(sizes.size() - 1));
  std::nth_element(sizes.begin(), sizes.begin() + at, sizes.end());
  return sizes[static_cast<std::size_t>(at)];
}

}  // namespace

double stamp_unit_seconds(const std::string& unit) {
  static constexpr Unit kTimes[] = {{"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}};
  for (const Unit& known : kTimes) {
    if (known.suffix == unit) return known.scale;
  }
  throw InputError("--stamp-unit", 0, quote_text(unit) + " is no unit; expected s, ms, us or ns");
}

std::string settle_units(CsvLayout& layout, const std::vector<std::vector<double>>& rows, const LogOptions& options) {
  std::string assumed;
  double range_size = -1.0;  // of all range columns together, once
  for (std::size_t i = 0; i < layout.columns.size(); ++i) {
    Column& column = layout.columns[i];
    if (column.scale != 0.0) continue;
    column.scale = 1.0;
    const char* unit = nullptr;
    if (column.role == ColumnRole::kStamp && !options.stamp_unit.empty()) {
      column.scale = stamp_unit_seconds(options.stamp_unit);
    } else if (column.role == ColumnRole::kStamp) {
      const double size = usual_size(layout, i, rows, 0.5);
      if (size > 1e17)
        column.scale = 1e-9, unit = "stamps in ns";
      else if (size > 1e14)
        column.scale = 1e-6, unit = "stamps in us";
      else if (size > 1e11)
        column.scale = 1e-3, unit = "stamps in ms";
    } else if (column.role == ColumnRole::kAngle || column.role == ColumnRole::kAngleMin ||
               column.role == ColumnRole::kAngleMax) {
      const double share = column.role == ColumnRole::kAngle ? 0.9 : 0.5;
      if (usual_size(layout, i, rows, share) > 2.0 * kPi + 0.01) column.scale = kPi / 180.0, unit = "angles in degrees";
    } else if (column.role == ColumnRole::kRange || column.role == ColumnRole::kPointX ||
               column.role == ColumnRole::kPointY) {
      if (range_size < 0.0) range_size = usual_size(layout, i, rows, 0.5);
      if (range_size > 100.0) column.scale = 1e-3, unit = "ranges in mm";
    }
    if (unit != nullptr && assumed.find(unit) == std::string::npos)
      assumed += (assumed.empty() ? "" : ", ") + std::string(unit);
  }
  // One unit for all beams of a scan, and one for all of its angles.
  const auto same_scale = [&layout](auto belongs) {
    double scale = 1.0;
    for (const Column& column : layout.columns) {
      if (belongs(column.role) && column.scale != 1.0) scale = column.scale;
    }
    for (Column& column : layout.columns) {
      if (belongs(column.role)) column.scale = scale;
    }
  };
  same_scale([](ColumnRole role) {
    return role == ColumnRole::kRange || role == ColumnRole::kPointX || role == ColumnRole::kPointY;
  });
  same_scale([](ColumnRole role) {
    return role == ColumnRole::kAngle || role == ColumnRole::kAngleMin || role == ColumnRole::kAngleMax ||
           role == ColumnRole::kAngleIncrement;
  });
  for (Column& column : layout.columns) {
    if (options.beams.clockwise && column.role == ColumnRole::kAngle) column.clockwise = true;
    if (column.clockwise) column.scale = -column.scale;
  }
  return assumed;
}

}  // namespace phasescan
