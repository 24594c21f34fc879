/// Point-to-point ICP ([Jiang19] Sec. 4, after [Besl92]): closest points by k-d tree, motion by SVD.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "phasescan/fft_icp/options.hpp"
#include "phasescan/core/pose2.hpp"
#include "fft_icp/icp/correspond.hpp"
#include "fft_icp/icp/covariance.hpp"
#include "scan/points.hpp"

namespace phasescan {

/// What ICP found.
struct IcpResult {
  Pose2 T_ref_scan;
  bool converged = false;  ///< an iteration moved less than the tolerances, at the final gate
  int iterations = 0;
  int pairs = 0;         ///< pairs of the last iteration
  double overlap = 0.0;  ///< pairs / points of the scan
  double rms_m = 0.0;    ///< root mean square distance of the pairs
};

/// The rigid motion that takes points s_i onto m_i in the least-squares sense, from their centred cross-covariance:
/// H = sum (s - mean s)(m - mean m)^T = U S V^T, R = V diag(1, det(V U^T)) U^T, T = mean m - R mean s. The diagonal
/// guards against a reflection, which collinear points (a corridor) otherwise give. [Jiang19] Sec. 4, [Arun87].
Pose2 rigid_motion(const Eigen::Matrix2d& cross_covariance, const Eigen::Vector2d& mean_s,
                   const Eigen::Vector2d& mean_m);

/// ICP with buffers that are kept between calls. One object per thread.
class Icp {
 public:
  explicit Icp(const IcpOptions& options = {}) : options_(options) {}

  /// Aligns `scan` with the indexed reference, starting at `guess`.
  ///
  /// @param guessed  whether there is a first estimate, so that the gate may start narrow
  /// @return the pose reached, also where it did not converge; `guess` unchanged without any pair.
  /// @cost O(iterations * n log m) at worst; a neighbour is searched anew only where the point moved so far that it may
  /// have
  ///       changed (half the gap between its two nearest points), so late iterations cost O(n).
  IcpResult align(const PointIndex& reference, const ScanPoints& scan, const Pose2& guess, bool guessed);

  /// The pairs of the last iteration; valid until the next `align`.
  std::span<const PointPair> pairs() const { return pairs_; }

 private:
  /// The neighbour of a scan point, true while the point stays within `safe_m` of where it was searched.
  struct Warm {
    float x, y, safe_squared;
    int index;
  };

  void trim_pairs();
  void find_pairs(const PointIndex& reference, double gate, std::size_t step);

  IcpOptions options_;
  std::vector<float> x_, y_;  ///< scan points in the reference frame
  std::vector<Warm> warm_;
  std::vector<PointPair> pairs_;
  std::vector<float> squared_;  ///< distance of each scan point to its neighbour
};

}  // namespace phasescan
