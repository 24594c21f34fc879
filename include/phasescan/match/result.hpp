/// What a match is told beside the two scans, and what it answers: never a bare pose.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string_view>
#include <vector>

#include "phasescan/core/options.hpp"
#include "phasescan/core/pose2.hpp"

namespace phasescan {

/// Why a match ended as it did. Only kConverged can be usable.
enum class MatchStatus {
  kConverged,      ///< a pose was found and passed every test of the method
  kNoPoints,       ///< one of the scans has no or too few hits
  kNoPeak,         ///< a correlation found nothing that stands out
  kNotConverged,   ///< the refinement did not settle within its iterations
  kLowOverlap,     ///< too few points of the scans found partners
  kLowConfidence,  ///< a pose was found, but it is not likely enough to be right
  kAmbiguous,      ///< another pose explains the scans as well (symmetric room, bare corridor)
};
template <>
std::span<const std::string_view> enum_names<MatchStatus>();

/// Which stage gave the rotation that won.
enum class RotationSource { kNone, kGuess, kMissingData, kSpectrum, kNormals, kSweep };
template <>
std::span<const std::string_view> enum_names<RotationSource>();

/// CPU milliseconds of all threads, from raw ranges of both scans to the result.
struct MatchTimes {
  double total = 0.0;
  double image = 0.0;        ///< points and scan images
  double missing = 0.0;      ///< missing-data features and their match
  double rotation = 0.0;     ///< spectra, polar sampling, correlation; for global rotation candidates
  double translation = 0.0;  ///< translation candidates
  double refine = 0.0;       ///< ICP, NDT or point-to-line refinement
};

/// How a match came about: for tables and for those who look inside. Nothing of it is needed to act on an answer.
struct MatchDiagnostics {
  RotationSource rotation_source = RotationSource::kNone;
  int iterations = 0;      ///< of the refinement
  double violation = 0.0;  ///< share of the hits of both where the other scan looked through, 0..1 (global)
  Eigen::Matrix3d noise_covariance =
      Eigen::Matrix3d::Identity() * 1e6;  ///< part of `covariance` that the noise of the ranges leaves (global)
  std::vector<double> features;  ///< what the confidence was computed from, see docs/global.md; empty without one
  MatchTimes ms;
};

/// Another pose that explains the scans.
struct MatchAlternative {
  Pose2 T_ref_scan;
  double confidence = 0.0;
};

/// The answer of a match.
struct MatchResult {
  Pose2 T_ref_scan;  ///< p_ref = R(theta) p_scan + (x, y): the best pose found, usable or not
  MatchStatus status = MatchStatus::kNoPoints;
  bool usable =
      false;  ///< may be acted on: confidence above match.min_confidence, or the method's own convergence test
  bool ambiguous = false;  ///< another pose explains the scans as well; `usable` is then false
  Eigen::Matrix3d covariance =
      Eigen::Matrix3d::Identity() * 1e6;  ///< of (x, y, theta), reference frame [m^2, m rad, rad^2], at most 1e6
  std::optional<double>
      confidence;        ///< probability of being within 0.1 m and 3 deg; empty for methods without calibration
  double overlap = 0.0;  ///< share of the scan's hits that found a partner, 0..1
  std::vector<MatchAlternative> alternatives;  ///< best first, without T_ref_scan itself
  MatchDiagnostics diagnostics;
};

/// What else is known of a pair of scans.
struct MatchHints {
  std::optional<Pose2> guess;  ///< T_ref_scan to start from; none: any rotation, no guess
  Twist2 reference_twist;      ///< motion of the sensor during the reference scan, taken out of it
  Twist2 scan_twist;           ///< the same for the scan
};

}  // namespace phasescan
