#include "phasescan/live/live.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <mutex>
#include <thread>

#include "live/bounded_queue.hpp"
#include "live/clocks.hpp"
#include "live/line_damage.hpp"
#include "live/live_tasks.hpp"

namespace phasescan::live {
namespace {

// Half a second of a sensor of 15 turns a second: what is older is of no use to who waits for poses.
constexpr std::size_t kScans = 8;
constexpr std::size_t kUpdates = 64;
// How long a task waits at most while no scan comes.
constexpr std::chrono::milliseconds kTaskWait{50};

/// The first thing that went wrong in any thread.
class FirstFailure {
 public:
  template <class Work>
  void guard(const Work& work) {
    try {
      work();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!failure_) failure_ = std::current_exception();
    }
  }
  bool any() const {
    const std::lock_guard lock(mutex_);
    return failure_ != nullptr;
  }
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  mutable std::mutex mutex_;
  std::exception_ptr failure_;
};

/// A sink with its thread and its queue.
class SinkThread {
 public:
  SinkThread(LiveSink& sink, FirstFailure& failure)
      : updates_(kUpdates), thread_([this, &sink, &failure] {
          failure.guard([&] {
            while (const auto update = updates_.pop()) sink.take(**update);
          });
        }) {}
  void push(std::shared_ptr<const LiveUpdate> update) { updates_.push(std::move(update)); }
  std::uint64_t join() {
    updates_.close();
    thread_.join();
    return updates_.dropped();
  }

 private:
  BoundedQueue<std::shared_ptr<const LiveUpdate>> updates_;
  std::thread thread_;
};

/// Scans in, updates out to all sinks; tasks between them.
void track(BoundedQueue<LiveScan>& scans, LiveEngine& engine, LiveTasks* tasks,
           const std::vector<std::unique_ptr<SinkThread>>& sinks, const std::function<void()>& between,
           LiveSummary& summary) {
  LineDamage damage;
  while (!scans.ended()) {
    if (tasks != nullptr && summary.scans > 0) LiveRunAccess::run(*tasks);
    auto scan = scans.pop_within(kTaskWait);
    if (!scan) continue;
    if (scan->restarts) engine.restart();
    auto update = std::make_shared<LiveUpdate>(
        engine.add(std::make_shared<const RangeMeasurement>(std::move(scan->measurement))));
    damage.add(scan->lost);
    damage.judge(*update);
    update->latency_ms = 1e-6 * static_cast<double>(steady_ns() - scan->arrived_ns);
    update->restarted = scan->restarts;
    update->dropped = scans.dropped();
    ++summary.scans;
    summary.worst_latency_ms = std::max(summary.worst_latency_ms, update->latency_ms);
    for (const auto& sink : sinks) sink->push(update);
    if (between && scans.empty()) between();
  }
}

}  // namespace

LiveSummary run_live(LiveSource& source, LiveEngine& engine, const std::vector<LiveSink*>& sinks, LiveTasks* tasks,
                     const std::function<bool()>& stop, const std::function<void(const std::string&)>& tell,
                     const std::function<void()>& between) {
  BoundedQueue<LiveScan> scans(kScans);
  FirstFailure failure;
  std::vector<std::unique_ptr<SinkThread>> shown;
  for (LiveSink* sink : sinks) shown.push_back(std::make_unique<SinkThread>(*sink, failure));
  LiveSummary summary;
  std::thread tracking([&] {
    failure.guard([&] { track(scans, engine, tasks, shown, between, summary); });
    if (tasks != nullptr) failure.guard([&] { LiveRunAccess::end(*tasks); });
  });
  failure.guard([&] {
    const auto stopped = [&] { return stop() || failure.any(); };
    const auto hand = [&](LiveScan scan) {
      while (source.can_wait() && !scans.wait_for_room(kTaskWait))
        if (stopped()) return;
      scans.push(std::move(scan));
    };
    source.run(stopped, hand, tell);
  });
  scans.close();
  tracking.join();
  for (const auto& sink : shown) summary.not_shown.push_back(sink->join());
  summary.dropped = scans.dropped();
  failure.rethrow();
  return summary;
}

LiveSummary run_live(LiveSource& source, Slam& slam, const std::function<bool()>& stop,
                     const std::function<void(const LiveUpdate&)>& sink,
                     const std::function<void(const std::string&)>& tell) {
  class OneSink final : public LiveSink {
   public:
    explicit OneSink(const std::function<void(const LiveUpdate&)>& sink) : sink_(sink) {}
    void take(const LiveUpdate& update) override { sink_(update); }

   private:
    const std::function<void(const LiveUpdate&)>& sink_;
  } one(sink);
  const auto engine = slam_engine(slam, [&slam] { return Slam(slam.options(), Schedule::kLatest); });
  return run_live(source, *engine, {&one}, nullptr, stop, tell);
}

}  // namespace phasescan::live
