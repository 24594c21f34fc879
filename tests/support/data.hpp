// Recorded data beside the source tree, for tests that use it where it is there.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include "support/paths.hpp"

namespace phasescan::test {

/// Path of a file or folder of the recorded data ($PHASESCAN_DATA, else ../shared/data beside the source root); empty
/// if absent: then GTEST_SKIP() with a line that says so.
inline std::string recorded_data(const std::string& name) {
  const char* folder = std::getenv("PHASESCAN_DATA");
  const std::string path = (folder != nullptr ? std::string(folder) : source_dir() + "/../shared/data") + "/" + name;
  std::error_code ignored;
  return std::filesystem::exists(path, ignored) ? path : "";
}

}  // namespace phasescan::test
