/// What is odd about the scans of a log, by kind and counted: warnings for people, damage for the exit code.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>

#include "phasescan/core/pose2.hpp"
#include "phasescan/core/time.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan {

struct InputOddity {
  std::size_t count = 0;
  bool damage = false;  ///< the input is broken there, not only unusual
  std::string first;    ///< where it was first seen and what it was
};

class InputCheck {
 public:
  /// The next laser message. @param where  "FILE:LINE" for messages; `laser` tells lasers apart
  /// @return false for a scan that should be passed over (it repeats the one before, bit for bit)
  bool add(const Scan& scan, const std::string& laser, const std::optional<Pose2>& odometry, const std::string& where);

  const std::map<std::string, InputOddity>& oddities() const { return oddities_; }
  bool damaged() const;

 private:
  void note(const std::string& kind, bool damage, const std::string& text);

  struct Laser {
    Stamp stamp = 0;
    std::size_t beams = 0;
    std::size_t fingerprint = 0;
  };
  std::map<std::string, Laser> lasers_;
  std::optional<Pose2> odometry_;
  Stamp odometry_stamp_ = 0;
  std::map<std::string, InputOddity> oddities_;
};

}  // namespace phasescan
