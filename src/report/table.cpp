#include "report/table.hpp"

#include <fmt/format.h>

#include <cmath>

#include "report/svg.hpp"

namespace phasescan {
namespace {

std::string markdown_cell(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '|') out += '\\';
    out += c == '\n' ? ' ' : c;
  }
  return out;
}

}  // namespace

std::string fixed(double value, int decimals) {
  if (!std::isfinite(value)) return "-";
  std::string out = fmt::format("{:.{}f}", value, decimals);
  if (out.front() == '-' && out.find_first_not_of("-0.") == std::string::npos) out.erase(0, 1);
  return out;
}

std::string percent(double share, int decimals) {
  return fixed(100.0 * share, decimals);
}

std::string Table::markdown() const {
  std::string out;
  if (!caption.empty()) out += fmt::format("{}\n\n", caption);
  const auto line = [&](const std::vector<std::string>& cells) {
    out += "|";
    for (std::size_t i = 0; i < header.size(); ++i)
      out += fmt::format(" {} |", i < cells.size() ? markdown_cell(cells[i]) : "");
    out += "\n";
  };
  line(header);
  out += "|";
  for (std::size_t i = 0; i < header.size(); ++i) out += i < text_columns ? "---|" : "---:|";
  out += "\n";
  for (const std::vector<std::string>& row : rows) line(row);
  return out;
}

std::string Table::html() const {
  std::string out = "<div>\n";  // the caption stands outside of what scrolls
  if (!caption.empty()) out += fmt::format("<p class=\"caption\">{}</p>\n", xml_escape(caption));
  out += "<div class=\"table\"><table>\n";
  const auto line = [&](const std::vector<std::string>& cells, const char* tag) {
    out += "<tr>";
    for (std::size_t i = 0; i < header.size(); ++i) {
      out += fmt::format("<{0}{1}>{2}</{0}>", tag, i < text_columns ? " class=\"word\"" : "",
                         i < cells.size() ? xml_escape(cells[i]) : "");
    }
    out += "</tr>\n";
  };
  line(header, "th");
  for (const std::vector<std::string>& row : rows) line(row, "td");
  return out + "</table></div>\n</div>\n";
}

}  // namespace phasescan
