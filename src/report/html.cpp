#include "report/html.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "report/svg.hpp"

namespace phasescan {
namespace {

constexpr std::string_view kStyle = R"css(
:root { color-scheme: light; }
body { margin: 0 auto; max-width: 62rem; padding: 1.2rem; color: #1a1a1a; background: #ffffff;
  font: 16px/1.55 system-ui, -apple-system, Segoe UI, Roboto, Helvetica, Arial, sans-serif; }
h1 { font-size: 1.7rem; line-height: 1.2; margin: .4rem 0; }
h2 { font-size: 1.3rem; margin: 2.4rem 0 .6rem; padding-top: .6rem; border-top: 1px solid #e3e5e8; }
h3 { font-size: 1.05rem; margin: 1.6rem 0 .4rem; }
p.lead { color: #5f6368; margin: 0 0 1rem; }
nav { columns: 16rem; font-size: .92rem; background: #f6f7f9; border-radius: .4rem; padding: .7rem 1rem; }
nav a { display: block; color: #0b57a4; text-decoration: none; }
figure { margin: 1rem 0; }
figure .frame { overflow-x: auto; }
figure svg { width: 100%; height: auto; display: block; }
figcaption { color: #5f6368; font-size: .88rem; margin-top: .3rem; }
.side { display: grid; gap: 1rem; grid-template-columns: repeat(auto-fit, minmax(20rem, 1fr)); }
.side figure { margin: 0; }
.table { overflow-x: auto; margin: 1rem 0; }
table { border-collapse: collapse; font-size: .9rem; font-variant-numeric: tabular-nums; }
p.caption { color: #5f6368; font-size: .88rem; margin: 1rem 0 .35rem; } .caption + .table { margin-top: 0; }
th, td { padding: .25rem .7rem; text-align: right; white-space: nowrap; border-bottom: 1px solid #e3e5e8; }
th { border-bottom: 1.5px solid #80868b; font-weight: 600; }
th.word, td.word { text-align: left; }
pre { overflow-x: auto; background: #f6f7f9; padding: .7rem 1rem; border-radius: .4rem; font-size: .85rem; }
@media print { nav { display: none; } body { max-width: none; font-size: 11pt; } figure, table { break-inside: avoid; } }
)css";

/// Width that a figure asks for, from the width attribute of its svg element.
double natural_width(std::string_view svg) {
  const std::size_t at = svg.find("width=\"");
  if (at == std::string_view::npos) return 500.0;
  double value = 0.0;
  for (std::size_t i = at + 7; i < svg.size() && svg[i] >= '0' && svg[i] <= '9'; ++i)
    value = 10.0 * value + (svg[i] - '0');
  return value > 0.0 ? value : 500.0;
}

std::string figure_html(std::string_view svg, std::string_view caption) {
  const double width = natural_width(svg);
  // On a narrow screen a wide figure scrolls instead of shrinking its text away.
  return fmt::format(
      "<figure><div class=\"frame\"><div style=\"max-width:{}px;min-width:{}px\">\n{}</div></div>"
      "<figcaption>{}</figcaption></figure>\n",
      static_cast<int>(1.35 * width), static_cast<int>(std::min(width, 0.62 * width + 120.0)), svg,
      xml_escape(caption));
}

}  // namespace

HtmlReport::HtmlReport(std::string_view title, std::string_view lead) : title_(title), lead_(lead) {}

void HtmlReport::heading(std::string_view text, int level) {
  if (level == 2) {
    sections_.push_back({fmt::format("s{}", sections_.size() + 1), std::string(text)});
    body_ += fmt::format("<h2 id=\"{}\">{}</h2>\n", sections_.back().id, xml_escape(text));
  } else {
    body_ += fmt::format("<h3>{}</h3>\n", xml_escape(text));
  }
}

void HtmlReport::paragraph(std::string_view text) {
  body_ += fmt::format("<p>{}</p>\n", xml_escape(text));
}

void HtmlReport::bullets(const std::vector<std::string>& items) {
  body_ += "<ul>\n";
  for (const std::string& item : items) body_ += fmt::format("<li>{}</li>\n", xml_escape(item));
  body_ += "</ul>\n";
}

void HtmlReport::figure(std::string_view svg, std::string_view caption) {
  body_ += figure_html(svg, caption);
}

void HtmlReport::figures(const std::vector<std::string>& svgs, const std::vector<std::string>& captions) {
  body_ += "<div class=\"side\">\n";
  for (std::size_t i = 0; i < svgs.size(); ++i) body_ += figure_html(svgs[i], captions.at(i));
  body_ += "</div>\n";
}

void HtmlReport::table(const Table& table) {
  body_ += table.html();
}

void HtmlReport::code(std::string_view text) {
  body_ += fmt::format("<pre>{}</pre>\n", xml_escape(text));
}

std::string HtmlReport::str() const {
  std::string contents;
  if (sections_.size() > 1) {
    contents = "<nav>\n";
    for (const Section& s : sections_) contents += fmt::format("<a href=\"#{}\">{}</a>\n", s.id, xml_escape(s.title));
    contents += "</nav>\n";
  }
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{0}</title>\n"
      "<style>{1}</style></head>\n<body>\n<h1>{0}</h1>\n<p class=\"lead\">{2}</p>\n{3}{4}</body></html>\n",
      xml_escape(title_), kStyle, xml_escape(lead_), contents, body_);
}

}  // namespace phasescan
