/// Revolutions of a simulated lidar: when each one takes place, whether it arrives, and what is wrong with its beams.
///
/// Every effect draws from a stream of its own, so that switching one on or off leaves the others' draws as they are.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/lidar.hpp"

namespace phasescan::sim {

/// When a revolution takes place.
struct RevolutionTime {
  double start_s = 0.0;
  double period_s = 0.0;
  bool lost = false;  ///< it never arrives
};

/// The revolutions that end by `duration_s`. Without a wander revolution k starts at k / rate_hz.
std::vector<RevolutionTime> plan_revolutions(const LidarOptions& lidar, double duration_s, std::uint64_t seed);

/// What happens to the beams of one revolution. Vectors are empty where their effect is off.
struct Revolution {
  double turn = 0.0;            ///< all beams look past their stated directions by this [rad]
  std::vector<double> offsets;  ///< and each one by this many beam steps; NaN = it has no sample
  std::vector<double> luck;     ///< uniform in [0, 1): a beam is lost where this is below its loss
  std::size_t gap_first = 0;    ///< first beam of the lost sector
  std::size_t gap_size = 0;     ///< its beams; 0 = all packets have come
  double period_s = 0.0;
};

/// Draws revolutions one after another and carries over what one leaves to the next.
class RevolutionSource {
 public:
  RevolutionSource(const LidarOptions& lidar, std::uint64_t seed);

  /// The next revolution. @param period_s  how long it takes
  Revolution next(double period_s);

  /// Leaves the lost sector out of raw ranges (0 = missing), and keeps them for the next revolution.
  void lose_sector(const Revolution& revolution, std::vector<float>& raw);

 private:
  void draw_offsets(Revolution& revolution);
  void draw_luck(Revolution& revolution);

  LidarOptions lidar_;
  std::uint64_t seed_;
  std::uint64_t count_ = 0;
  double next_sample_ = 0.0;     ///< place of the next sample, in beam steps from the revolution's first beam
  std::vector<double> luck_;     ///< of the revolution before
  std::vector<float> previous_;  ///< raw ranges of the revolution before, as they were before its own loss
};

}  // namespace phasescan::sim
