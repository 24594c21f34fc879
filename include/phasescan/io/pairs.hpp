/// Pairs files: JSON Lines of two scans and, where known, the true pose between them (CONTRACT: pairs file).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "phasescan/core/pose2.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan {

/// One line of a pairs file.
struct ScanPair {
  std::string id;
  std::string dataset;
  std::string cls;             ///< small, middle, large, global, none, or whatever the file says
  Scan reference;
  Scan scan;
  std::optional<Pose2> truth;  ///< T_ref_scan; empty for class none or where the file has no truth
  std::optional<double> overlap;               ///< share of the surface that both scans see, 0..1; simulated pairs know it
  std::optional<Eigen::Matrix3d> information;  ///< best possible, of (x, y, theta) in the reference frame; simulated pairs know it
};

}  // namespace phasescan
