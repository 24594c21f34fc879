#include "io/csv_rows.hpp"

#include <cmath>

#include "io/csv_log.hpp"
#include "io/text_numbers.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kLookAheadRows = 2000;
constexpr std::size_t kLookAheadNumbers = 200'000;
constexpr std::size_t kHeaderLines = 50;
constexpr std::size_t kMostBeamsOfARow = 1'000'000;

/// The layout a line gives as a header, if it is one. "# angle distance quality" is.
std::optional<CsvLayout> layout_of_line(std::string_view line) {
  while (!line.empty() && (line.front() == '#' || line.front() == '%' || line.front() == ' ')) line.remove_prefix(1);
  std::vector<std::string_view> names;
  const char separator = guess_separator(line);
  split_fields(line, separator, names);
  const auto layout = make_layout(names, separator);
  // A header of x and y is a trajectory's more often than that of points: those are read with --columns alone.
  return layout && layout->find(ColumnRole::kRange) != nullptr ? layout : std::nullopt;
}

/// "(1.0, inf, nan)" or "[1.0, 2.0]": what a list looks like that was written as text.
bool parse_array(std::string_view text, std::vector<double>& out) {
  if (text.size() < 2) return false;
  const char close = text.front() == '(' ? ')' : text.front() == '[' ? ']' : '\0';
  if (close == '\0' || text.back() != close) return false;
  text = text.substr(1, text.size() - 2);
  std::vector<std::string_view> fields;
  split_fields(text, text.find(',') == std::string_view::npos ? ' ' : ',', fields);
  if (!fields.empty() && fields.back().empty()) fields.pop_back();  // "(1.0,)", "()"
  return fields.size() <= kMostBeamsOfARow && parse_numbers(fields, out);
}

double middle_range(std::vector<double> ranges) {
  ranges.erase(std::remove_if(ranges.begin(), ranges.end(), [](double r) { return !std::isfinite(r) || r <= 0.0; }),
               ranges.end());
  if (ranges.empty()) return 0.0;
  const auto middle = ranges.begin() + static_cast<std::ptrdiff_t>(ranges.size() / 2);
  std::nth_element(ranges.begin(), middle, ranges.end());
  return *middle;
}

bool is_comment(std::string_view line) {
  return line.empty() || line.front() == '#';
}

}  // namespace

CsvRowReader::CsvRowReader(LogInput& input, const LogOptions& options) : TextLogReader(input) {
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
    guess_separator_ = columns_named_ = true;
  } else {
    find_header();
  }
  look_ahead(options);
}

void CsvRowReader::find_header() {
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

void CsvRowReader::look_ahead(const LogOptions& options) {
  std::vector<std::vector<double>> rows;
  std::size_t numbers = 0;
  while (ahead_.size() < kLookAheadRows && numbers < kLookAheadNumbers) {
    std::optional<Row> row = parse_row();
    if (!row) break;
    rows.push_back(row->numbers);
    // An array stands in one column: one of its ranges speaks for all.
    if (const Column* column = layout_.find(ColumnRole::kRange); row->arrays && column != nullptr)
      rows.back()[static_cast<std::size_t>(column - layout_.columns.data())] = middle_range(row->ranges);
    numbers += row->numbers.size() + row->ranges.size();
    ahead_.push_back(std::move(*row));
  }
  assumed_ = settle_units(layout_, rows, options);
}

std::optional<CsvRowReader::Row> CsvRowReader::next_row() {
  if (ahead_.empty()) return parse_row();
  Row row = std::move(ahead_.front());
  ahead_.pop_front();
  return row;
}

/// The next line of numbers. Columns that nobody reads may hold anything; an empty range is a missing return.
std::optional<CsvRowReader::Row> CsvRowReader::parse_row() {
  std::string line;
  while (next_line(line)) {
    if (is_comment(line)) continue;
    if (guess_separator_) layout_.separator = guess_separator(line), guess_separator_ = false;
    Row row;
    row.line = line_number();
    row.arrays = line.find('"') != std::string::npos;
    if (row.arrays) {
      split_quoted_fields(line, layout_.separator, fields_);
    } else {
      split_fields(line, layout_.separator, fields_);
    }
    if (is_whole(row.arrays) && parse_fields(row)) return row;
  }
  return std::nullopt;
}

/// Whether a row has as many fields as it should.
bool CsvRowReader::is_whole(bool arrays) {
  const bool open_end = layout_.columns.back().open_end && !arrays;
  // A row of any length is whole where it ends; without an end, where it is as long as the one before, or the only one.
  const bool only_one = fields_before_ == 0 && columns_named_;
  if (open_end && !line_was_ended() && fields_.size() != fields_before_ && !only_one) {
    damage_here("truncated line", "the file ends inside the line");
    return false;
  }
  lone_line_ = open_end && !line_was_ended() && only_one;
  fields_before_ = fields_.size();
  if (open_end ? fields_.size() >= layout_.columns.size() : fields_.size() == layout_.columns.size()) return true;
  damage_here("wrong count",
              std::to_string(fields_.size()) + " fields; expected " + std::to_string(layout_.columns.size()));
  return false;
}

bool CsvRowReader::parse_fields(Row& row) {
  row.numbers.reserve(fields_.size());
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    if (parse_field(i, row)) continue;
    damage_here("bad number",
                "field " + std::to_string(i + 1) + " is " + quote_text(fields_[i]) + "; expected a number");
    return false;
  }
  return true;
}

bool CsvRowReader::parse_field(std::size_t i, Row& row) {
  const ColumnRole role = column_at(i).role;
  const bool is_array = role == ColumnRole::kRange || role == ColumnRole::kIntensity;
  if (row.arrays && is_array && !column_at(i).indexed) {
    row.numbers.push_back(0.0);
    return parse_array(fields_[i], role == ColumnRole::kRange ? row.ranges : row.intensities);
  }
  std::optional<double> value =
      role == ColumnRole::kStamp ? stamp_field(fields_[i], row) : parse_number<double>(fields_[i]);
  if (!value && (role == ColumnRole::kIgnored || (role == ColumnRole::kRange && fields_[i].empty()))) value = 0.0;
  if (value) row.numbers.push_back(*value);
  return value.has_value();
}

std::optional<double> CsvRowReader::stamp_field(std::string_view text, Row& row) {
  row.stamp_integer = parse_number<std::int64_t>(text);
  row.stamp_seconds = parse_stamp(text);
  if (const auto number = parse_number<double>(text)) return number;
  row.clock = parse_clock_stamp(text);
  if (!row.clock) return std::nullopt;
  if (text[2] == ':') row.clock = days_.unrolled(*row.clock);
  return 0.0;
}

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

}  // namespace phasescan
