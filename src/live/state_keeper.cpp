#include "live/state_keeper.hpp"

#include <algorithm>
#include <utility>

#include "io/file.hpp"
#include "live/clocks.hpp"
#include "phasescan/io/error.hpp"

namespace phasescan::live {
namespace {

constexpr int kRest = 9;  // times as long as saving took

}  // namespace

StateKeeper::StateKeeper(std::string path, double every_s, std::function<void(const std::string&)> tell)
    : path_(std::move(path)), every_s_(every_s), tell_(std::move(tell)), thread_([this] { work(); }) {}

StateKeeper::~StateKeeper() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void StateKeeper::scan_added(Slam& slam) {
  if (every_s_ <= 0.0) return;
  {
    const std::lock_guard lock(mutex_);
    if (busy_ || waiting_ || steady_ns() < due_ns_) return;
  }
  SavedRun run{slam.checkpoint(), slam.options()};
  {
    const std::lock_guard lock(mutex_);
    waiting_ = std::move(run);
  }
  changed_.notify_all();
}

bool StateKeeper::finish(Slam& slam) {
  {
    std::unique_lock lock(mutex_);
    waiting_.reset();
    changed_.wait(lock, [this] { return !busy_; });
  }
  return write({slam.checkpoint(), slam.options()});
}

bool StateKeeper::write(const SavedRun& run) {
  try {
    write_file(path_, encode_state(run));
    told_ = false;
    return true;
  } catch (const std::exception& error) {  // tracking goes on, and the next time there may be room
    if (!std::exchange(told_, true)) tell_(std::string(error.what()) + "; the state is not saved, tracking goes on");
    return false;
  }
}

void StateKeeper::work() {
  for (;;) {
    std::optional<SavedRun> run;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return ends_ || waiting_; });
      if (!waiting_) return;
      run = std::exchange(waiting_, std::nullopt);
      busy_ = true;
    }
    const std::int64_t begin = steady_ns();
    write(*run);
    run.reset();
    const std::int64_t end = steady_ns();
    {
      const std::lock_guard lock(mutex_);
      busy_ = false;
      due_ns_ = end + std::max(kRest * (end - begin), static_cast<std::int64_t>(1e9 * every_s_));
    }
    changed_.notify_all();
  }
}

}  // namespace phasescan::live
