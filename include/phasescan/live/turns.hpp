/// Beams in, scans out: one per turn of the head.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "phasescan/live/decoder.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan::live {

struct TurnCounts {
  std::uint64_t turns = 0;
  std::uint64_t partial = 0;     ///< left out: cut off, void or with less than half a turn in them
  std::uint64_t lost_beams = 0;  ///< that lie where packets are missing; in the scans they are invalid
};

/// Puts beams together into turns. The first turn, which began before anyone listened, is left out. A scan is stamped
/// with its first beam, and its time_increment is what its beams took on average; beams of lost packets are there
/// without a range, so that the times of the others are right. Beams lie in the order of their directions.
class TurnAssembler {
 public:
  /// @param range_min, range_max  of the sensor; 0: unknown [m]
  void add(std::span<const Beam> beams, double range_min, double range_max, std::vector<Scan>& out);
  /// What is open is void: the line was cut.
  void restart();
  const TurnCounts& counts() const { return counts_; }

 private:
  void add_one(const Beam& beam, std::vector<Scan>& out);
  void fill_lost(const Beam& beam, std::vector<Scan>& out);
  void finish(std::vector<Scan>& out);
  Scan scan_of_turn() const;

  std::vector<Beam> beams_;
  bool open_ = false;
  double swept_ = 0.0;  ///< since the turn's first beam [rad]; NaN: the sensor does not say
  double step_ = 0.0;   ///< usual, between beams [rad]
  double range_min_ = 0.0, range_max_ = 0.0;
  TurnCounts counts_;
};

}  // namespace phasescan::live
