#include "io/csv_rows.hpp"

#include "io/csv_log.hpp"
#include "io/text_numbers.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kLookAheadRows = 2000;
constexpr std::size_t kLookAheadNumbers = 200'000;
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
    guess_separator_ = true;
  } else {
    find_header();
  }
  look_ahead();
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

void CsvRowReader::look_ahead() {
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

bool CsvRowReader::parse_fields(Row& row) {
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
