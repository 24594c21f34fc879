// Saved runs as the command keeps them: the state of SLAM, and what the command knows beside it.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

#include "phasescan/slam/state.hpp"
#include "slam_output.hpp"

namespace phasescan::app {

struct LoadedRun {
  SavedRun saved;
  SlamRun run;
};

/// @throws InputError for a file that is not there, is no state or a damaged one; SystemError
LoadedRun load_run(const std::string& path);
/// Of bytes that were read from `path`. @throws InputError
LoadedRun load_run(const std::string& path, std::string_view bytes);
/// The options of a run that goes on: its own where no settings file is named, else those of the file, with a warning
/// that names what differs. @throws InputError where it cannot go on with these
SlamOptions options_to_go_on(const SavedRun& saved, const std::string& file, const SlamOptions& given);
/// The bytes of a file that may be a state. @throws InputError, SystemError
std::string read_state_bytes(const std::string& path);
/// Whether a file begins as a state does; false for what cannot be read.
bool is_state_file(const std::string& path);

/// Writes a run and what the command knows beside it. @throws SystemError
void save_run(const std::string& path, const SlamState& state, const SlamOptions& options, const SlamRun& run);

/// Writes the state of a run that goes on, now and then.
class StateSaver {
 public:
  /// Saves nothing where `path` is empty. @param every_s  0: only when asked
  /// What a killed run left beside `path` is deleted.
  StateSaver(std::string path, double every_s);
  /// After a scan: saves where it is time; after the first one at once. @throws SystemError
  void scan_added(Slam& slam, const SlamRun& run);
  /// @throws SystemError
  void save(Slam& slam, const SlamRun& run);

 private:
  std::string path_;
  double every_s_;
  std::optional<std::chrono::steady_clock::time_point> last_;
};

}  // namespace phasescan::app
