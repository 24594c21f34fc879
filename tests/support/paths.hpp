/// Where the source tree and the built command lie.
#pragma once

#include <string>

namespace phasescan::test {

/// The root of the source tree, without a slash at its end.
std::string source_dir();
/// The built `phasescan` command.
std::string command_path();

}  // namespace phasescan::test
