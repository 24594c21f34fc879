#include <CLI/CLI.hpp>

int main(int argc, char** argv) {
  CLI::App app{"phasescan: the motion between two lidar scans, with no first guess", "phasescan"};
  app.set_version_flag("--version", PHASESCAN_VERSION);
  app.require_subcommand(0, 1);
  CLI11_PARSE(app, argc, argv);
  return 0;
}
