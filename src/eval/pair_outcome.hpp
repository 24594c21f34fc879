/// One answer of one method for one pair of scans, judged against the truth.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "io/pairs.hpp"
#include "phasescan/match/result.hpp"

namespace phasescan {

/// Success as in [Jiang19] Sec. 5.2: closer than both to the true pose.
inline constexpr double kSuccessTranslation_m = 0.1;
inline constexpr double kSuccessRotation_deg = 3.0;

/// The scans of class `none` show two places: no pose is right and any usable answer is wrong.
inline constexpr const char* kNoneClass = "none";

/// What is kept of a match for the tables and figures.
struct PairOutcome {
  std::string id;
  std::string dataset;
  std::string source = {};  ///< where the pair came from, see separate_sources
  std::string cls;
  std::size_t method = 0;  ///< index into the methods of the run
  bool has_truth = false;  ///< false: class none
  bool right = false;      ///< within 0.1 m and 3 deg of the truth, whatever `usable` says
  bool usable = false;
  double error_x = 0.0, error_y = 0.0;  ///< signed, in the reference frame [m]; 0 without a truth
  double error_theta = 0.0;             ///< signed [rad]
  std::optional<double> confidence;
  std::vector<double> features = {};                          ///< of MatchResult
  double nees = std::numeric_limits<double>::quiet_NaN();     ///< e^T C^-1 e; NaN without a truth or for a singular C
  double overlap = std::numeric_limits<double>::quiet_NaN();  ///< of the two scans at the true pose, see scan_overlap
  double efficiency =
      std::numeric_limits<double>::quiet_NaN();  ///< e^T J e, J the simulator's information of both scans; else NaN
  double weak_sigma_m = 0.0;    ///< largest standard deviation J leaves in any direction [m]; 0 where J is unknown
  double error_across_m = 0.0;  ///< error across that direction, where the pose is well known [m]
  bool ambiguous = false;
  RotationSource rotation_source = RotationSource::kNone;
  MatchTimes ms;

  double translation_error() const;
};

/// Where a pair's information comes from.
enum class InformationSource {
  kSimulator,  ///< exact: an error can be held against the Cramer-Rao bound
  kSurfaces,   ///< of the scans themselves, see surface_information: tells corridors only
};

/// From here on a direction counts as one that nobody can know (a bare corridor).
inline constexpr double kWeakSigma_m = 0.05;
inline bool is_weak(const PairOutcome& outcome) {
  return outcome.weak_sigma_m > kWeakSigma_m;
}

/// Judges an answer. `overlap` is taken as given (it is the same for every method).
PairOutcome judge(const ScanPair& pair, const MatchResult& result, std::size_t method, double overlap,
                  const std::optional<Eigen::Matrix3d>& information = {},
                  InformationSource source = InformationSource::kSimulator);

/// How much of the two scans shows the same surfaces: of each scan the share of hits that have a hit of the other
/// within 0.1 m + 1.5 times the gap between the other's beams at that range; the smaller of the two shares. 0 if either
/// has no hit.
/// @cost O(n m)
double scan_overlap(const Scan& reference, const Scan& scan, const Pose2& T_ref_scan);

}  // namespace phasescan
