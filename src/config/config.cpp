#include "config/config.hpp"

namespace phasescan {

OptionTable option_table(Config& config) {
  OptionTable table;
  Config::visit_sections(config, [&](std::string_view section, auto& options) { table.add(section, options); });
  table.add_alias("mh", "global");
  return table;
}

Config load_config(const std::string& path) {
  Config config;
  option_table(config).load_file(path);
  return config;
}

}  // namespace phasescan
