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
  OptionTable table = option_table(config);
  table.load_file(path);
  config.sections_set = table.loaded_sections();
  config.options_set = table.loaded_options();
  config.slam.match = {config.match.match.general, config.match.global};
  return config;
}

}  // namespace phasescan
