/// Drives on maps that SLAM made of earlier drives: tracked, kidnapped, begun anywhere, with furniture moved since.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "eval/localize_places.hpp"
#include "eval/statistics.hpp"
#include "phasescan/localize/localizer.hpp"

namespace phasescan {

struct LocalizeRunsSpec {
  std::vector<std::string> worlds;  ///< KIND:SEED, a map each
  std::string sensor = "rplidar-a1-real";
  std::size_t kidnaps = 20;      ///< in each world
  double kidnaps_per_m = 0.005;  ///< probability
  double starts_every_m = 20.0;  ///< a localizer that knows nothing begins; 0: none but the first
  double moved = 0.0;            ///< share of the furniture and doors that are elsewhere than when the map was made
  double unmapped = 0.0;         ///< share of the rooms that are wiped from the map
  int people = 0;
  double speed_mps = 0.5;
  std::uint64_t seed = 1;
};

/// What was said of a scan of the drives, and what was so.
struct DrivenScan {
  LocalizationUpdate update;
  Pose2 T_map_base;      ///< the truth
  bool mapped = false;   ///< it stands where the map has free space
  bool started = false;  ///< within 2 m of way after an unknown start
};

/// A moment from which the robot's place is not known: carried elsewhere, or switched on.
struct UnknownStart {
  bool kidnapped = false;        ///< else a localizer that knows nothing
  bool first_ambiguous = false;  ///< what the first scan said
  double noticed_s = 0.0;        ///< until the first scan that is not ok at a wrong place
  double wrong_ok_s = 0.0;       ///< longest time of being ok at a wrong place within the way below
  bool recovered = false;        ///< ok and right within 2 m of way
  double recovered_s = 0.0;
};

struct LocalizeRunsScore {
  std::size_t wrong_maps = 0;  ///< worlds left out: their map is off by more than a pose may be
  std::vector<UnknownStart> starts;
  // Scans more than 2 m of way after an unknown start.
  std::size_t off_map = 0, off_map_wrong_ok = 0;  ///< where the map has no free space: not counted below
  std::size_t scans = 0, ok = 0, wrong_ok = 0, right_ok = 0, degraded = 0, ambiguous = 0, lost = 0;
  double way_m = 0.0;
  std::vector<Judgement> judgements;  ///< of these scans, where there is a pose and none is as likely
  std::vector<double> errors_m;       ///< of poses that are ok
  double longest_lost_s = 0.0;        ///< lost or without a pose, at a stretch
  double longest_wrong_ok_s = 0.0;    ///< ok at a wrong place, at a stretch
  std::vector<double> cpu_ms;         ///< of scans that were tracked without a search
};

/// What became of kidnapped robots, and of those that were switched on during a drive.
struct StartsScore {
  std::size_t kidnapped = 0, noticed_late = 0, recovered = 0;  ///< late: ok at a wrong place for more than 1 s
  double recovery_s_mean = 0.0;
  std::size_t begun = 0, begun_found = 0, begun_ambiguous = 0, begun_ambiguous_found = 0;
  std::size_t wrong_ok_long = 0;  ///< of all: ok at a wrong place for more than 1 s at a stretch
};
StartsScore score_of(const std::vector<UnknownStart>& starts);

/// @param progress  called after each world  @param each  called for every scan, where it is given
LocalizeRunsScore run_drives(const LocalizeRunsSpec& spec, const LocalizeOptions& options,
                             const std::function<void()>& progress,
                             const std::function<void(const DrivenScan&)>& each = {});

}  // namespace phasescan
