/// Files of configs/ inside the program (cmake/PhasescanEmbed.cmake).
#pragma once

#include <span>
#include <string_view>

namespace phasescan::sim {

struct EmbeddedFile {
  std::string_view name;  ///< path below configs/, e.g. "sensors/rplidar-a1.yaml"
  std::string_view text;
};

/// All of them, sorted by name.
std::span<const EmbeddedFile> embedded_files();

}  // namespace phasescan::sim
