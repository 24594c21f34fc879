/// Beams in, scans out: one per turn of the head.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "phasescan/live/decoder.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan::live {

struct TurnCounts {
  std::uint64_t turns = 0;
  std::uint64_t partial = 0;     ///< left out: cut off, void or with less than half a turn in them
  std::uint64_t lost_beams = 0;  ///< that lie where packets are missing; in the scans they are invalid
  std::uint64_t torn = 0;  ///< turns void because time and direction went on differently: not one turn of the head
};

/// Puts beams together into turns. The first turn, which began before anyone listened, is left out. A scan is stamped
/// with its first beam, and its time_increment is what its beams took on average; beams of lost packets are there
/// without a range, so that the times of the others are right. Beams lie in the order of their directions. A turn in
/// which the head would have had to jump, or to stand still, is void: its beams are of two turns, or not where they
/// say.
class TurnAssembler {
 public:
  /// @param range_min, range_max  of the sensor; 0: unknown [m]
  void add(std::span<const Beam> beams, double range_min, double range_max, std::vector<Scan>& out);
  /// What is open is void: the line was cut.
  void restart();
  const TurnCounts& counts() const { return counts_; }

 private:
  void add_one(const Beam& beam, std::vector<Scan>& out);
  double turned_since(const Beam& beam) const;
  bool goes_on(const Beam& beam);
  void fill_lost(const Beam& beam, std::vector<Scan>& out);
  void finish(std::vector<Scan>& out);
  Scan scan_of_turn() const;

  std::vector<Beam> beams_;
  bool open_ = false;
  double swept_ = 0.0;   ///< since the turn's first beam [rad]; NaN: the sensor does not say
  double step_ = 0.0;    ///< usual, between beams [rad]
  double turn_s_ = 0.0;  ///< usual, of a turn; 0: not known
  int torn_in_a_row_ = 0;
  std::optional<Beam> closed_;  ///< the last beam where no turn is open since one was torn
  double range_min_ = 0.0, range_max_ = 0.0;
  TurnCounts counts_;
};

}  // namespace phasescan::live
