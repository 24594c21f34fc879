/// Saved runs: a run of SLAM as a file, from which any later build goes on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "phasescan/slam/options.hpp"
#include "phasescan/slam/slam.hpp"

namespace phasescan {

/// A file that is no saved run, or a damaged one: what is wrong and what was expected, in one line.
class StateError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A part of a file.
struct StateFileSection {
  std::string name;
  std::size_t bytes = 0, unpacked_bytes = 0;
};

/// A run with the options that it was made with, and what the caller keeps beside it.
struct SavedRun {
  SlamState state;
  SlamOptions options;
  std::map<std::string, std::string> notes = {};  ///< by name, of at most 15 letters: bytes that are the caller's own
  // Of the file that it was read from:
  std::uint32_t version = 0;
  std::vector<StateFileSection> sections = {};
};

/// Bytes of a file. @cost about 60 ms for 10,000 scans
std::string encode_state(const SavedRun& run);
/// Bytes may be anything: what is read takes no more memory than they justify. @throws StateError
SavedRun decode_state(std::string_view bytes);

/// Writes a file whole or not at all: a kill at any moment leaves the old or the new one. @throws std::system_error
void write_state(const std::string& path, const SavedRun& run);
/// @throws StateError naming the file; std::system_error where it cannot be read
SavedRun read_state(const std::string& path);

/// Whether bytes begin as a saved run does.
bool is_saved_state(std::string_view first_bytes);

/// What a saved run holds.
struct StateSummary {
  std::size_t scans = 0, keyframes = 0, nodes = 0, loops = 0, places = 0;
  int drives = 0;
  int pieces = 0;  ///< that nothing ties
  Stamp first_stamp = 0, last_stamp = 0;
  double path_length_m = 0.0;  ///< from keyframe to keyframe
  std::vector<std::string> lasers;
};
StateSummary summarize(const SlamState& state);

/// Several runs as one.
struct MergedStates {
  SlamState state;
  /// Which of the given runs comes first, second, ... in it: they stand in the order of time, so that the order in
  /// which they were given says no more than the frame.
  std::vector<std::size_t> order;
};
/// Ties runs to each other where they show the same places, with no guess. The frame is that of the first one given;
/// what cannot be tied to it stays a piece by itself, kilometres beside. Going on, the merged run goes on with the
/// last.
/// @throws std::invalid_argument for no run, one without a scan, or options by which their scans are not kept
/// @cost 2 ms a keyframe
MergedStates merge_states(const std::vector<SlamState>& runs, const SlamOptions& options);

/// Options that differ between two runs and matter for going on: "odometry.cell_m 0.1, was 0.05".
struct OptionDifferences {
  std::vector<std::string> harmless;  ///< what follows is tracked otherwise
  std::vector<std::string> fatal;     ///< a run cannot go on with these
};
OptionDifferences compare_options(const SlamOptions& now, const SlamOptions& before);

}  // namespace phasescan
