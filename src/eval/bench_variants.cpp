#include <algorithm>
#include <stdexcept>

#include "eval/bench.hpp"
#include "config/option_table.hpp"

namespace phasescan {
namespace {

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(' ');
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

void set(const OptionTable& table, const std::string& assignment) {
  const std::size_t dot = assignment.find('.'), equals = assignment.find('=');
  if (dot == std::string::npos || equals == std::string::npos || equals < dot)
    throw std::invalid_argument("'" + assignment + "'; expected SECTION.OPTION=VALUE");
  const std::string section = trimmed(assignment.substr(0, dot)),
                    name = trimmed(assignment.substr(dot + 1, equals - dot - 1));
  const OptionEntry* entry = table.find(section, name);
  if (entry == nullptr) throw std::invalid_argument("no option " + section + "." + name);
  try {
    entry->set(trimmed(assignment.substr(equals + 1)));
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(section + "." + name + ": " + error.what());
  }
}

}  // namespace

BenchMethod bench_variant(const std::string& text, const AnyMatchOptions& options) {
  const std::size_t colon = text.find(':');
  BenchMethod variant{trimmed(text.substr(0, colon)), options};
  if (colon == std::string::npos || variant.name.empty())
    throw std::invalid_argument("--variant '" + text + "'; expected NAME: SECTION.OPTION=VALUE, ...");
  OptionTable table;
  AnyMatchOptions::visit_sections(variant.options,
                                  [&](std::string_view section, auto& values) { table.add(section, values); });
  table.add_alias("mh", "global");
  try {
    for (std::size_t start = colon + 1; start < text.size();) {
      const std::size_t comma = std::min(text.find(',', start), text.size());
      set(table, text.substr(start, comma - start));
      start = comma + 1;
    }
    variant.options.validate();
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("--variant '" + variant.name + "': " + error.what());
  }
  return variant;
}

}  // namespace phasescan
