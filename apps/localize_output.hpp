// The files that `phasescan localize` leaves in its folder.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "io/file.hpp"
#include "people.hpp"
#include "phasescan/localize/localizer.hpp"

namespace phasescan::app {

/// What a run of localisation knows.
struct LocalizeRun {
  std::string log, map_name, format, odometry_assumed;
  bool odometry_used = false;
  bool complete = true;
  bool each = false;
  bool times = true;
  double min_confidence = 0.95;
  std::vector<LocalizationUpdate> updates;  ///< one per scan
  std::vector<float> cpu_ms;                ///< one per scan
  double prepare_cpu_s = 0.0;
  std::optional<bool> map_was_kept;  ///< where that was asked for: whether the map was read as it had been prepared
  double free_area_m2 = 0.0;
  std::size_t views = 0, map_bytes = 0;
  std::map<std::string, std::size_t> damages;  ///< of the reader, by kind
};

struct LocalizeReason {
  std::string kind;
  std::size_t count = 0;
  Stamp first_stamp = 0;
  std::string what;
};

/// How the run went as a whole.
struct LocalizeVerdict {
  std::string word;  ///< good, doubtful, failed
  double probability = 0.0;
  std::vector<LocalizeReason> reasons;  ///< strongest first
  std::array<std::size_t, 5> by_status{};
};
LocalizeVerdict judge_run(const LocalizeRun& run);

/// trajectory.tum, localization.jsonl, summary.json, report.html: written, not yet in place. @throws SystemError
FileSet localize_output(const std::string& folder, const TrinaryMap& map, const LocalizeRun& run,
                        const LocalizeVerdict& verdict);

std::vector<EndingLine> localize_ending(const LocalizeRun& run, const LocalizeVerdict& verdict,
                                        const std::string& folder);

}  // namespace phasescan::app
