#include "live/recorder.hpp"

#include <chrono>
#include <utility>

#include "live/clocks.hpp"
#include "phasescan/io/error.hpp"

namespace phasescan::live {
namespace {

// Half of what a kill may cost: the other half is for a slow machine.
constexpr std::int64_t kFlush_ns = 500'000'000;
constexpr std::int64_t kPath_ns = 5'000'000'000;
constexpr double kMap_s = 5.0;
// Half a minute of a fast sensor: a card that is busy with itself takes some seconds.
constexpr std::size_t kWaiting = 512;

}  // namespace

Recorder::Recorder(const std::string& path, std::function<void(const std::string&)> tell)
    : path_(free_name(path)), tell_(std::move(tell)), file_(GrowingFile(path_)), queue_(kWaiting) {
  if (path_ != path) tell_(path + " is there already; recording to " + path_);
  thread_ = std::thread([this] { work(); });
  drawer_.emplace(kMap_s, [this](Stamp stamp, const DrawnMap& map) {
    if (!map->cells.empty()) queue_.push({{}, map_message(stamp, *map)});
  });
}

Recorder::~Recorder() {
  close();
}

void Recorder::add(const LiveUpdate& live) {
  if (failed_ || closed_) return;
  drawer_->offer(live.update.stamp, live.map);
  queue_.push({live, {}});
}

bool Recorder::close() {
  if (!closed_.exchange(true)) {
    drawer_.reset();
    queue_.close();
    thread_.join();
  }
  return !failed_;
}

RecorderCounts Recorder::counts() const {
  return {scans_, queue_.dropped(), bytes_, failed_};
}

void Recorder::guarded(const std::function<void()>& writing) {
  if (failed_) return;
  try {
    writing();
    bytes_ = file_.size();
  } catch (const SystemError& error) {
    failed_ = true;
    tell_(std::string(error.what()) + "; recording ends here, tracking goes on");
  }
}

bool Recorder::write(const Item& item) {
  if (item.map) file_.add(item.map->topic, item.map->type, item.map->stamp, item.map->bytes);
  if (!item.live || item.live->update.repeated) return false;
  for (const RosMessage& message : view_.of(*item.live))
    file_.add(message.topic, message.type, message.stamp, message.bytes);
  ++scans_;
  if (steady_ns() < path_due_ns_) return true;
  path_due_ns_ = steady_ns() + kPath_ns;
  const RosMessage path = path_message(*item.live);
  file_.add(path.topic, path.type, path.stamp, path.bytes);
  return true;
}

void Recorder::work() {
  // The first scan is written at once, what follows in pieces: there is never more than a piece to lose.
  std::int64_t due_ns = steady_ns();
  bool waiting = false;
  while (!queue_.ended()) {
    const auto item = queue_.pop_within(std::chrono::milliseconds(100));
    guarded([&] {
      if (item && write(*item)) waiting = true;
      if (!waiting || steady_ns() < due_ns) return;
      file_.flush();
      waiting = false;
      due_ns = steady_ns() + kFlush_ns;
    });
  }
  guarded([&] { file_.finish(); });
}

}  // namespace phasescan::live
