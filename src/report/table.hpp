/// Tables of text, as Markdown and as HTML.
#pragma once

#include <string>
#include <vector>

namespace phasescan {

/// Rows of cells under a header. The first `text_columns` columns are words and stand left, the others are numbers and
/// stand right.
struct Table {
  std::string caption;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
  std::size_t text_columns = 1;

  /// A GitHub Markdown table, caption above it; `|` in cells is escaped.
  std::string markdown() const;
  /// A <div><table> of well-formed HTML, wide ones scroll sideways.
  std::string html() const;
};

/// Number with fixed decimals; "-" for NaN and infinities.
std::string fixed(double value, int decimals);
/// 0.973 -> "97.3"; "-" for NaN.
std::string percent(double share, int decimals = 1);

}  // namespace phasescan
