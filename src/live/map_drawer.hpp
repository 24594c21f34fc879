// Draws the map now and then beside a run, in a thread of its own.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

#include "phasescan/live/live.hpp"

namespace phasescan::live {

using DrawnMap = std::shared_ptr<const TrinaryMap>;

/// Draws where the map is another than the one drawn last, and `every_s` have passed since that one. A map that takes
/// long is drawn less often, so that drawing never takes more than a tenth of a core.
class MapDrawer {
 public:
  /// @param drawn  by the drawing thread: the stamp of the scan that the map was offered with, and the map
  MapDrawer(double every_s, std::function<void(Stamp, DrawnMap)> drawn);
  /// Draws once more where the last map that was offered was not drawn.
  ~MapDrawer();
  MapDrawer(const MapDrawer&) = delete;
  MapDrawer& operator=(const MapDrawer&) = delete;

  /// Never waits. The one before is forgotten.
  void offer(Stamp stamp, std::shared_ptr<const MapSnapshot> map);

 private:
  void work();

  const double every_s_;
  const std::function<void(Stamp, DrawnMap)> drawn_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::shared_ptr<const MapSnapshot> offered_;
  Stamp stamp_ = 0;
  bool ends_ = false;
  std::thread thread_;
};

}  // namespace phasescan::live
