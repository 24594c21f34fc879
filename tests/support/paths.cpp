#include "paths.hpp"

namespace phasescan::test {

std::string source_dir() {
  return PHASESCAN_SOURCE_DIR;
}

std::string command_path() {
  return PHASESCAN_COMMAND;
}

}  // namespace phasescan::test
