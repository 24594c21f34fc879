/// What is odd about the measurements of a run, by kind and counted: warnings for people, damage for the exit code.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "phasescan/core/time.hpp"
#include "phasescan/scan/scan.hpp"
#include "phasescan/slam/slam.hpp"

namespace phasescan {

/// What is remembered of the input. Plain values.
struct InputCheckState {
  static constexpr int kVersion = 1;
  struct Laser {
    Stamp stamp = 0;
    std::uint64_t beams = 0;
    std::uint64_t fingerprint = 0;  ///< of the ranges, bit for bit

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("stamp", self.stamp);
      v("beams", self.beams);
      v("fingerprint", self.fingerprint);
    }
  };
  std::map<LaserId, Laser> lasers;
  std::optional<Pose2> odometry;
  Stamp odometry_stamp = 0;
  std::map<std::string, InputOddity> oddities;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("lasers", self.lasers);
    v("odometry", self.odometry);
    v("odometry_stamp", self.odometry_stamp);
    v("oddities", self.oddities);
  }
};

/// One oddity of one measurement.
struct OddityNote {
  std::string kind;
  bool damage = false;
  std::string what;
};

/// What the check says of one measurement.
struct InputVerdict {
  bool repeated = false;          ///< the one before, bit for bit: it should be passed over
  std::vector<OddityNote> notes;  ///< in the order of the checks
};

/// Counts an oddity. @param scan  number of the scan
void note_oddity(InputCheckState& state, const OddityNote& note, ScanId scan);

/// Judges the next measurement and remembers it. @param scan  its number
InputVerdict check_input(InputCheckState& state, const RangeMeasurement& measurement, ScanId scan);

}  // namespace phasescan
