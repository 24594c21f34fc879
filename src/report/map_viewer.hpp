/// The part of a report that shows a map to zoom and pan, and every scan where and when it stood.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "phasescan/slam/slam.hpp"

namespace phasescan {

/// Hits of one scan in the frame of the base, x y x y ... [cm].
struct ShownScan {
  std::size_t scan = 0;  ///< index of the run's scans
  std::vector<std::int16_t> points_cm;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("scan", self.scan);
    v("points_cm", self.points_cm);
  }
};

/// Keeps scans for a report in bounded memory: all of a short run, every second, fourth, ... of a longer one.
class ShownScans {
 public:
  static constexpr std::size_t kMost = 400;       ///< scans: some 200 kB of the page
  static constexpr std::size_t kMostPoints = 90;  ///< of a scan
  void add(std::size_t index, const Scan& upright, const Pose2& T_base_laser);
  /// Those of another run, whose scans follow. @param first  the index of its first scan
  void append(const ShownScans& other, std::size_t first);
  std::span<const ShownScan> scans() const { return scans_; }
  std::size_t every() const { return every_; }

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("scans", self.scans_);
    v("every", self.every_);
  }

 private:
  std::vector<ShownScan> scans_;
  void thin_out();
  std::size_t every_ = 1;
};

/// HTML with its own script and nothing from elsewhere: a canvas, buttons, a slider over time.
std::string map_viewer(const SlamResult& result, const ShownScans& shown);

}  // namespace phasescan
