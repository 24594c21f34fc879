/// What to assume of the motion where a scan does not show it: along bare corridors.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "scan/surface.hpp"

namespace phasescan {

/// Compares the relief of the walls, the little that each hit stands out from its neighbours' line, beam by beam with
/// that of the scan before. A sensor at rest sees the same bumps again; one that moves does not, however bare the
/// walls.
class ReliefWitness {
 public:
  /// Correlation with the scan before, -1..1; empty with few beams in common. @cost O(beams)
  std::optional<double> add(const SurfacePoints& surface);

 private:
  std::vector<float> last_, now_;  // by beam [m], NaN where nothing is known
};

/// How this robot moves, learned where its scans show it: how alike scans are at rest, and how far it usually goes from
/// scan to scan driving and turning. Deterministic, bounded.
class MotionHabits {
 public:
  struct Assumption {
    double x = 0, y = 0;         ///< motion of the base during the usual period, in its frame [m]
    Eigen::Matrix2d covariance;  ///< [m^2]
  };

  /// Takes the next scan's surface in.
  void add(const SurfacePoints& surface);
  /// What to assume of the motion up to the scan just added in place of "it goes on as it did"; empty: nothing.
  /// @param turn  during the usual period [rad]
  std::optional<Assumption> assume(double turn) const;
  /// What to expect of the next step after `step`: the same again; where scans do not show it, a little nearer to what
  /// is usual, for small errors of a speed that is not seen would add up.
  Pose2 expect(const Pose2& step) const;
  /// What was found of the same scan. @param step  during the usual period  @param seen  the match shows it in each
  /// direction
  void learn(const Pose2& step, bool seen);

 private:
  enum class Gait { kStill, kDriving, kTurning };
  struct Usual {
    double mean = 0.0;
    std::size_t count = 0;
    void add(double value);
  };
  struct UsualStep {
    Usual x, y, xx, yy;
  };
  bool alike(double likeness) const;
  Gait gait(double turn) const;

  ReliefWitness relief_;
  std::optional<double> likeness_;
  int alike_in_a_row_ = 0;
  Usual likeness_still_, likeness_moving_;
  UsualStep driving_, turning_;
  Gait last_ = Gait::kDriving;
  bool seen_ = true;  // the last step, in each direction
};

}  // namespace phasescan
