/// Everything that a configuration file can set, in one place.
#pragma once

#include <string>
#include <vector>

#include "config/option_table.hpp"
#include "methods/any_options.hpp"
#include "phasescan/localize/options.hpp"
#include "phasescan/slam/options.hpp"

namespace phasescan {

/// The options of all stages.
struct Config {
  AnyMatchOptions match;
  SlamOptions slam;
  LocalizeOptions localize;
  std::vector<std::string> sections_set;  ///< those that the file names
  std::vector<std::string> options_set;   ///< the same, as "section.name"

  /// Calls v(section_name, section_struct) for every section, in the order of `config --dump`.
  template <class Self, class Visitor>
  static void visit_sections(Self& self, Visitor&& v) {
    AnyMatchOptions::visit_sections(self.match, v);
    SlamOptions::visit_sections(self.slam, v);
    v("localize", self.localize);
  }
};

/// The table over `config`'s sections; `config` must outlive it.
OptionTable option_table(Config& config);

/// Defaults with a YAML file's values over them. @throws as OptionTable::load_file.
Config load_config(const std::string& path);

}  // namespace phasescan
