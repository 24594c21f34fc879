// phasescan config --dump [SECTION]: every option in force.
#include "command_list.hpp"
#include "commands.hpp"

namespace phasescan::app {
namespace {

struct ConfigFlags {
  CommonFlags common;
  bool dump = false;
  std::string section;
};

}  // namespace

void add_config_command(CLI::App& app, CommandBody& body) {
  auto* command = app.add_subcommand("config", "every option in force, with its default, unit and meaning");
  auto flags = std::make_shared<ConfigFlags>();
  command->add_flag("--dump", flags->dump, "print the options as YAML")->required();
  command->add_option("SECTION", flags->section, "only this section");
  add_config_flag(*command, flags->common);
  command->footer("Example:\n  phasescan config --dump slam");
  command->callback([flags, &body] {
    body = [flags] {
      Config config = config_from(flags->common);
      print(option_table(config).dump(flags->section));
      return kDone;
    };
  });
}

}  // namespace phasescan::app
