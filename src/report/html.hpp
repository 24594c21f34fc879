/// A report in one HTML file: headings, text, tables and embedded SVG, readable on a phone, on paper and with no
/// network.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "report/table.hpp"

namespace phasescan {

/// Collects parts in order. All text is escaped; the document is well-formed.
class HtmlReport {
 public:
  /// `lead` is the sentence under the title.
  HtmlReport(std::string_view title, std::string_view lead);

  /// A section of the table of contents (level 2) or a part of one (level 3).
  void heading(std::string_view text, int level = 2);
  void paragraph(std::string_view text);
  void bullets(const std::vector<std::string>& items);
  /// `svg` is a document of SvgCanvas; `caption` stands under it.
  void figure(std::string_view svg, std::string_view caption);
  /// Figures side by side where the page is wide enough; `svgs` and `captions` of one length.
  void figures(const std::vector<std::string>& svgs, const std::vector<std::string>& captions);
  void table(const Table& table);
  void code(std::string_view text);
  /// HTML as it stands, not escaped.
  void raw(std::string_view html) { body_ += html; }

  std::string str() const;

 private:
  struct Section {
    std::string id, title;
  };
  std::string title_, lead_;
  std::vector<Section> sections_;
  std::string body_;
};

}  // namespace phasescan
