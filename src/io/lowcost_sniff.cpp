// Telling the low-cost text formats from each other, and from a matrix of ranges.
#include <algorithm>
#include <span>
#include <vector>

#include "io/lowcost_log.hpp"
#include "io/lowcost_text.hpp"
#include "io/text_numbers.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kLinesLookedAt = 20;

/// Rows of numbers from the beginning of a text: the first lines that are whole and no comment, one without numbers as
/// an empty row.
std::vector<std::vector<double>> first_rows(std::string_view text, bool& commas) {
  std::vector<std::vector<double>> rows;
  std::vector<std::string_view> fields;
  while (!text.empty() && rows.size() < kLinesLookedAt) {
    const std::size_t end = text.find('\n');
    // What was cut off tells nothing, unless it is all there is.
    if (end == std::string_view::npos && !rows.empty()) break;
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (line.find_first_not_of(" \t") == std::string_view::npos || line.front() == '#') continue;
    if (rows.empty()) commas = line.find(',') != std::string_view::npos;
    split_fields(line, commas ? ',' : ' ', fields);
    rows.emplace_back();
    if (!parse_numbers(fields, rows.back())) rows.back().clear();
  }
  return rows;
}

bool are_ranges(std::span<const double> values, double most, bool integers) {
  return std::all_of(values.begin(), values.end(),
                     [=](double r) { return r >= 0.0 && r <= most && (!integers || r == std::floor(r)); });
}

bool fits_slambot(const std::vector<double>& row) {
  return row.size() == kSlambotNumbers && is_integer_up_to(row[0], 65536) && is_integer_up_to(row[1], 65536) &&
         is_integer_up_to(row[2], 65536) && are_ranges(std::span(row).subspan(3), 32768.0, true);
}
bool fits_breezy(const std::vector<double>& row) {
  return row.size() == kBreezyHead + kBreezyBeams + 1 && is_integer_up_to(row[0], 1e6 * kMostStampSeconds) &&
         is_integer_up_to(row[2], 1e12) && is_integer_up_to(row[3], 1e12) &&
         are_ranges(std::span(row).subspan(kBreezyHead, kBreezyBeams), 65536.0, true);
}
/// A distance, a turn, a time between scans, and ranges in metres with now and then a wild one.
bool fits_polar(const std::vector<double>& row) {
  if (row.size() < kPolarHead + kFewestPolarBeams || !(row[2] > 0.0 && row[2] < 1e6)) return false;
  const auto ranges = std::span(row).subspan(kPolarHead);
  const auto usual = std::count_if(ranges.begin(), ranges.end(), [](double r) { return r >= 0.0 && r <= 30.0; });
  return usual * 100 >= static_cast<std::ptrdiff_t>(ranges.size()) * 98;
}

/// Whether the clock of two rows after each other ran on by no more than `most`; one that wraps does so at 2^16.
bool runs_on(double before, double now, bool wraps, double most) {
  const double step =
      wraps ? static_cast<double>(static_cast<std::uint16_t>(wrapped_difference(now, before))) : now - before;
  return step > 0.0 && step <= most;
}

/// Numbers alone are no format: a matrix of ranges has them, too. At least half of the first rows must fit, and the
/// column that is a clock must run on.
template <class Fits>
bool rows_fit(const std::vector<std::vector<double>>& rows, Fits fits, std::optional<std::size_t> clock, bool wraps,
              double most_step) {
  std::size_t fitting = 0, steps = 0, running = 0;
  const std::vector<double>* before = nullptr;
  for (const auto& row : rows) {
    if (!fits(row)) continue;
    ++fitting;
    if (before != nullptr && clock) {
      ++steps;
      running += runs_on((*before)[*clock], row[*clock], wraps, most_step);
    }
    before = &row;
  }
  return 2 * fitting >= rows.size() && 10 * running >= 8 * steps;
}

}  // namespace

std::optional<LowcostFormat> sniff_lowcost(std::string_view beginning) {
  bool commas = false;
  const auto rows = first_rows(beginning, commas);
  if (rows.empty()) return std::nullopt;
  if (commas) {
    // Its sensor never gives the same number of ranges for long; a matrix always does.
    const auto same_count = [&rows](const std::vector<double>& row) { return row.size() == rows[0].size(); };
    const bool varies = !std::all_of(rows.begin(), rows.end(), same_count);
    return varies && rows_fit(rows, fits_polar, std::nullopt, false, 0.0) ? std::optional(LowcostFormat::kPolar)
                                                                          : std::nullopt;
  }
  if (rows_fit(rows, fits_slambot, 2, true, 5000.0)) return LowcostFormat::kSlambot;
  if (rows_fit(rows, fits_breezy, 0, false, 1e7)) return LowcostFormat::kBreezy;
  return std::nullopt;
}

}  // namespace phasescan
