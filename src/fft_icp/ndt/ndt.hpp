/// Normal distributions transform ([Biber03]): scan points against Gaussians in the cells of a grid, by Newton steps.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "phasescan/fft_icp/options.hpp"
#include "phasescan/core/pose2.hpp"
#include "scan/points.hpp"

namespace phasescan {

/// Value and derivatives of the NDT score at a pose.
struct NdtScore {
  double value = 0.0;                                  ///< -sum exp(-q^T B q / 2): lower is better
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();  ///< by (x, y, theta)
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
  int inside = 0;  ///< points within three sigma of the Gaussian of a cell
};

/// The Gaussians of one scan: four grids, shifted by half a cell against each other ([Biber03] Sec. III).
class NdtMap {
 public:
  /// @cost O(n + cells); allocates only while it grows. Cells farther than 256 cells from the sensor are left out.
  void build(const ScanPoints& points, double cell_m, const NdtOptions& options);

  /// The score of `scan` moved by T_ref_scan ([Biber03] Eq. 9-13). @cost O(n)
  NdtScore evaluate(const ScanPoints& scan, const Pose2& T_ref_scan) const;

 private:
  struct Cell {
    double mean_x, mean_y;
    double b_xx, b_xy, b_yy;  ///< inverse covariance
  };
  struct Grid {
    double left = 0.0, low = 0.0;
    int cols = 0, rows = 0;
    std::vector<std::int32_t> cell;  ///< index into cells_, -1 where there is no Gaussian
  };

  double per_cell_ = 1.0;  ///< 1 / cell size
  Grid grids_[4];
  std::vector<Cell> cells_;
};

/// What NDT found.
struct NdtResult {
  Pose2 T_ref_scan;
  bool converged = false;
  int iterations = 0;
  double overlap = 0.0;  ///< share of the scan's points within three sigma of a Gaussian of the last level
  NdtScore score;        ///< at T_ref_scan, last level
};

/// A reference prepared for NDT: one map per level.
using NdtLevels = std::vector<NdtMap>;
void build_ndt(const ScanPoints& points, const NdtOptions& options, NdtLevels& out);

/// Minimises the score, level by level from the coarsest. Where the Hessian is not positive definite it is made so by
/// adding to its diagonal; a step that makes the score worse is halved. @pre reference was built with the same options.
/// @cost O(iterations * n)
NdtResult align_ndt(const NdtLevels& reference, const ScanPoints& scan, const Pose2& guess, const NdtOptions& options);

}  // namespace phasescan
