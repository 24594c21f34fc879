/// Scans kept small: what is the same in all scans of a laser kept once, ranges as steps from beam to beam.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan {

/// What scans of one laser have in common.
struct ScanKind {
  ScanGeometry geometry;
  double time_increment = 0.0;
  std::vector<float> angles;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("angle_min", self.geometry.angle_min);
    v("angle_increment", self.geometry.angle_increment);
    v("range_min", self.geometry.range_min);
    v("range_max", self.geometry.range_max);
    v("time_increment", self.time_increment);
    v("angles", self.angles);
  }
};

/// One scan: ranges to 2 mm, up to 130 m (hits beyond are kept as out of range), and the reason of every missing beam;
/// intensities are not kept. Immutable, so that it is shared between threads.
class StoredScan {
 public:
  StoredScan() = default;  ///< of no beams; only to be read into
  StoredScan(const Scan& scan, const Pose2& T_base_laser, std::shared_ptr<const ScanKind> kind);
  Scan scan() const;
  /// Whether `scan` can be asked for: of what was read from a file.
  bool is_sound() const;
  const Pose2& T_base_laser() const { return T_base_laser_; }  ///< of this scan: a mounting may jitter or pan

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("stamp", self.stamp_);
    v("T_base_laser", self.T_base_laser_);
    v("kind", self.kind_);
    v("beams", self.beams_);
    v("codes", self.codes_);
  }

 private:
  Stamp stamp_ = 0;
  Pose2 T_base_laser_;
  std::shared_ptr<const ScanKind> kind_;
  std::uint32_t beams_ = 0;
  std::vector<std::uint8_t> codes_;  // of each beam the step from the one before, in one byte to three
};

/// The scans of a run, each with a number.
class ScanStore {
 public:
  static constexpr int kVersion = 1;
  /// @return the number to ask for it with
  std::size_t add(const Scan& scan, const Pose2& T_base_laser);
  /// Takes the scans of another store in after its own; they are shared.
  void append(const ScanStore& other);
  /// @throws std::out_of_range
  Scan scan(std::size_t index) const { return entries_.at(index)->scan(); }
  const Pose2& T_base_laser(std::size_t index) const { return entries_.at(index)->T_base_laser(); }
  std::shared_ptr<const StoredScan> stored(std::size_t index) const { return entries_.at(index); }
  std::size_t size() const { return entries_.size(); }
  /// Sets of angles and limits that are kept: one a laser as a rule.
  std::size_t kinds() const { return kinds_.size(); }

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("kinds", self.kinds_);
    v("scans", self.entries_);
  }

 private:
  std::vector<std::shared_ptr<const ScanKind>> kinds_;
  std::vector<std::shared_ptr<const StoredScan>> entries_;
};

}  // namespace phasescan
