/// Scans kept small: 16 bits a range, what is the same in all scans of a laser kept once.
#pragma once

#include <cstdint>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan {

/// Ranges to 2 mm, up to 130 m (hits beyond are kept as out of range), and the reason of every missing beam;
/// intensities are not kept.
class ScanStore {
 public:
  /// @return the number to ask for it with
  std::size_t add(const Scan& scan, const Pose2& T_base_laser);
  /// @throws std::out_of_range
  Scan scan(std::size_t index) const;
  const Pose2& T_base_laser(std::size_t index) const { return entries_.at(index).T_base_laser; }
  std::size_t size() const { return entries_.size(); }
  /// Sets of angles and limits that are kept: one a laser as a rule.
  std::size_t kinds() const { return kinds_.size(); }

 private:
  struct Kind {
    ScanGeometry geometry;
    double time_increment = 0.0;
    std::vector<float> angles;
  };
  struct Entry {
    Stamp stamp = 0;
    std::uint32_t kind = 0;
    Pose2 T_base_laser;  // of this scan: a mounting may jitter or pan
    std::vector<std::uint16_t> ranges;
  };
  std::vector<Kind> kinds_;
  std::vector<Entry> entries_;
};

}  // namespace phasescan
