/// What the columns of a text log of ranges hold, by their names and, where the names give no unit, by the numbers.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "phasescan/io/log.hpp"

namespace phasescan {

/// What one column is. kRange and kIntensity stand once in a log of single beams and many times in a log of whole
/// scans.
enum class ColumnRole {
  kIgnored,
  kStamp,
  kStampSeconds,  ///< with kStampNanoseconds: a stamp in two columns
  kStampNanoseconds,
  kAngle,
  kRange,
  kIntensity,
  kScanNumber,
  kScanStart,
  kAngleMin,
  kAngleIncrement,
  kAngleMax,
  kRangeMin,
  kRangeMax,
  kTimeIncrement,
  kOdomX,
  kOdomY,
  kOdomTheta,
  kPointX,  ///< a beam as the point it hit
  kPointY
};

struct Column {
  ColumnRole role = ColumnRole::kIgnored;
  double scale = 1.0;  ///< times the number = SI (negative for clockwise angles); 0 = not stated
  bool clockwise = false;
  bool from_header = false;  ///< a stamp of the message's own header
  bool indexed = false;      ///< one of many: ranges0, range_12, r[3]
  bool open_end = false;     ///< `ranges` without a number: this column and all that follow
};

/// Names as tools write them: case, quotes, a leading % or "field." do not matter; a unit is a suffix (`range_mm`,
/// `angle_deg`, `time [ms]`), `_cw` a clockwise angle.
Column parse_column(std::string_view name);

/// Columns of a header line or of --columns, and what they make together.
struct CsvLayout {
  std::vector<Column> columns;
  char separator = ',';
  bool whole_scans = false;  ///< a scan a line; else a beam a line

  const Column* find(ColumnRole role) const;
};

/// Nothing where the names do not make a log: no ranges and no points, or single ranges without angles.
std::optional<CsvLayout> make_layout(const std::vector<std::string_view>& names, char separator);

/// Comma, semicolon, tab or blanks: what separates the fields of this line.
char guess_separator(std::string_view line);

/// Units that no name states, as the user says or from the first rows: angles beyond 2 pi are degrees, ranges beyond
/// 100 millimetres, stamps by their size seconds, milli-, micro- or nanoseconds. Returns what was assumed, for people,
/// empty if nothing.
std::string settle_units(CsvLayout& layout, const std::vector<std::vector<double>>& rows,
                         const LogOptions& options = {});

/// A flag's text for a unit of time (s, ms, us, ns) in seconds. @throws InputError
double stamp_unit_seconds(const std::string& unit);

}  // namespace phasescan
