#include "live/map_drawer.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

#include "phasescan/core/time.hpp"

namespace phasescan::live {
namespace {

using Clock = std::chrono::steady_clock;
constexpr double kRest = 9.0;  // times as long as drawing took

}  // namespace

MapDrawer::MapDrawer(double every_s, std::function<void(Stamp, DrawnMap)> drawn)
    : every_s_(every_s), drawn_(std::move(drawn)), thread_([this] { work(); }) {}

MapDrawer::~MapDrawer() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void MapDrawer::offer(Stamp stamp, std::shared_ptr<const MapSnapshot> map) {
  {
    const std::lock_guard lock(mutex_);
    offered_ = std::move(map);
    stamp_ = stamp;
  }
  changed_.notify_all();
}

void MapDrawer::work() {
  std::optional<std::uint64_t> drawn_version;
  auto next = Clock::now();
  for (;;) {
    std::shared_ptr<const MapSnapshot> map;
    Stamp stamp = 0;
    {
      std::unique_lock lock(mutex_);
      changed_.wait_until(lock, next, [this] { return ends_; });
      changed_.wait(lock, [&] { return ends_ || (offered_ && offered_->version() != drawn_version); });
      if (!offered_ || offered_->version() == drawn_version) return;
      map = offered_;
      stamp = stamp_;
    }
    const double begin_s = thread_cpu_seconds();
    drawn_(stamp, std::make_shared<const TrinaryMap>(map->draw()));
    drawn_version = map->version();
    // Of this thread's own work: a busy machine is no reason to draw less.
    const double rest_s = std::max(kRest * (thread_cpu_seconds() - begin_s), every_s_);
    next = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(rest_s));
  }
}

}  // namespace phasescan::live
