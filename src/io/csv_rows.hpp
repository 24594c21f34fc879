// Rows of numbers of a CSV log: its header, its units, one line after another.
#pragma once

#include <algorithm>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "io/clock_stamp.hpp"
#include "io/csv_columns.hpp"
#include "io/text_log.hpp"

namespace phasescan {

/// Reads rows for a reader that makes scans of them. The first rows are looked at ahead, for units that are not stated.
class CsvRowReader : public TextLogReader {
 public:
  /// @throws InputError where neither a header nor --columns names ranges.
  CsvRowReader(LogInput& input, const LogOptions& options);

 protected:
  struct Row {
    long line = 0;
    std::vector<double> numbers;
    std::optional<std::int64_t> stamp_integer;  ///< a stamp as it stands there: 19 digits do not fit into a double
    std::optional<Stamp> stamp_seconds;         ///< the same read as decimal seconds
    std::optional<Stamp> clock;                 ///< a stamp as clocks write it; without a date of the running day
    bool arrays = false;  ///< ranges and intensities stand in one quoted field each: in the two below, as written
    std::vector<double> ranges, intensities;
  };

  std::optional<Row> next_row();
  const CsvLayout& layout() const { return layout_; }
  /// The file is one line that does not end: nothing tells whether it is whole.
  bool is_lone_line() const { return lone_line_; }
  /// The units that were taken for granted, for people.
  const std::string& assumed() const { return assumed_; }

  const Column& column_at(std::size_t field) const {
    return layout_.columns[std::min(field, layout_.columns.size() - 1)];
  }

  /// A row's number of a role in SI units.
  std::optional<double> value(const std::vector<double>& numbers, ColumnRole role) const {
    const Column* column = layout_.find(role);
    if (column == nullptr) return std::nullopt;
    return numbers[static_cast<std::size_t>(column - layout_.columns.data())] * column->scale;
  }

 private:
  void find_header();
  void look_ahead(const LogOptions& options);
  std::optional<Row> parse_row();
  bool is_whole(bool arrays);
  bool parse_fields(Row& row);
  bool parse_field(std::size_t i, Row& row);
  std::optional<double> stamp_field(std::string_view text, Row& row);

  CsvLayout layout_;
  bool guess_separator_ = false, columns_named_ = false, lone_line_ = false;
  ClockDays days_;
  std::string assumed_;
  std::vector<std::string_view> fields_;
  std::size_t fields_before_ = 0;
  std::deque<Row> ahead_;
};

}  // namespace phasescan
