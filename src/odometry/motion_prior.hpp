/// What to assume of the motion where a scan does not show it: along bare corridors.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "scan/surface.hpp"

namespace phasescan {

/// Compares the relief of the walls, how far each hit stands out from its neighbours' line, beam by beam with that of
/// the scan before. A sensor at rest sees the same bumps again; one that moves does not, however bare the walls. Plain
/// values.
struct ReliefCorrelation {
  std::vector<float> relief;  ///< of the last scan, by beam [m], NaN where nothing is known

  /// Correlation with the scan before, -1..1; empty with few beams in common. @cost O(beams)
  std::optional<double> add(const SurfacePoints& surface);
};

enum class MotionState { kStill, kDriving, kTurning };

/// How this robot moves, learned where its scans show it: how alike scans are at rest, and how far it usually goes from
/// scan to scan driving and turning. Deterministic, bounded, plain values.
struct MotionPrior {
  /// A mean that forgets.
  struct Usual {
    double mean = 0.0;
    std::size_t count = 0;
    void add(double value);
    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("mean", self.mean);
      v("count", self.count);
    }
  };
  /// Of a step's x, y and their squares.
  struct UsualStep {
    Usual x, y, xx, yy;
    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("x", self.x);
      v("y", self.y);
      v("xx", self.xx);
      v("yy", self.yy);
    }
  };
  /// Motion of the base during the usual period, in its frame.
  struct Step {
    double x = 0, y = 0;         ///< [m]
    Eigen::Matrix2d covariance;  ///< [m^2]
  };

  ReliefCorrelation relief;
  std::optional<double> likeness;  ///< of the scan just observed to the one before; made anew with each, not kept
  int alike_in_a_row = 0;
  Usual likeness_still, likeness_moving;
  UsualStep driving, turning;
  MotionState last = MotionState::kDriving;
  bool seen = true;  ///< the last step was seen in each direction

  /// Takes the next scan's surface in.
  void observe(const SurfacePoints& surface);
  /// What to assume of the motion up to the scan just observed in place of "it goes on as it did"; empty: nothing.
  /// @param turn  during the usual period [rad]
  std::optional<Step> prior_for(double turn) const;
  /// What to expect of the next step after `step`: the same again; where scans do not show it, a little nearer to what
  /// is usual, for small errors of a speed that is not seen would add up.
  Pose2 expect(const Pose2& step) const;
  /// What was found of the same scan. @param step  during the usual period  @param determined  the match shows it in
  /// each direction
  void learn(const Pose2& step, bool determined);

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("relief", self.relief.relief);
    v("alike_in_a_row", self.alike_in_a_row);
    v("likeness_still", self.likeness_still);
    v("likeness_moving", self.likeness_moving);
    v("driving", self.driving);
    v("turning", self.turning);
    v("last", self.last);
    v("seen", self.seen);
  }

 private:
  bool alike(double value) const;
  MotionState state_of(double turn) const;
};

}  // namespace phasescan
