/// Parts of the robot in the laser's view: directions whose range does not depend on where the robot is.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "phasescan/match/scan_matcher.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan {

inline constexpr std::size_t kBodyBins = 360;  ///< directions of one degree, counter-clockwise from x forward

/// From direction `from` counter-clockwise to `to` [rad].
struct BodySector {
  double from = 0.0, to = 0.0;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("from", self.from);
    v("to", self.to);
  }
};
/// "155 to -150 deg, 12 to 20 deg".
std::string format_sectors(const std::vector<BodySector>& sectors);
/// The scan without the beams in the sectors.
Scan without_sectors(const Scan& scan, const std::vector<BodySector>& sectors);

/// What pairs of scans said of one direction.
struct BodyVotes {
  std::uint16_t seen = 0;          ///< pairs in which both scans have a range here
  std::uint16_t same = 0;          ///< it was the same in both
  std::uint16_t contradicted = 0;  ///< and something that stands in the scene cannot have stood there in both

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("seen", self.seen);
    v("same", self.same);
    v("contradicted", self.contradicted);
  }
};

/// Plain values.
struct OwnBodyState {
  static constexpr int kVersion = 1;
  std::array<BodyVotes, kBodyBins> votes{};
  std::optional<Scan> reference;  ///< the first scan of the next pair
  std::size_t pairs = 0, tried = 0;
  int wait = 0;                     ///< scans to be passed over; -1: the scan before differed from the reference
  bool decided = false;             ///< the sectors are final
  std::vector<BodySector> sectors;  ///< empty: no body was found

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("votes", self.votes);
    v("reference", self.reference);
    v("pairs", self.pairs);
    v("tried", self.tried);
    v("wait", self.wait);
    v("decided", self.decided);
    v("sectors", self.sectors);
  }
};

/// Looks at the scans of one laser until it is decided. Scans are compared once the scene has changed: matched with no
/// guess, without what stayed the same, which shows where the robot moved; what then stayed the same although nothing
/// that stands still can have done so is the robot. At rest nothing is told.
class OwnBody {
 public:
  explicit OwnBody(const MatchOptions& options = {}) : matcher_(options) {}
  /// @return true when this scan decided it
  /// @cost O(beams), and a match for every pair; nothing once it is decided
  bool add(const Scan& scan, OwnBodyState& state);

 private:
  ScanMatcher matcher_;
};

}  // namespace phasescan
