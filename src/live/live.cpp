#include "phasescan/live/live.hpp"

#include <chrono>
#include <exception>
#include <mutex>
#include <thread>

#include "live/clocks.hpp"
#include "live/bounded_queue.hpp"

namespace phasescan::live {
namespace {

// Half a second of a sensor of 15 turns a second: what is older is of no use to who waits for poses.
constexpr std::size_t kScans = 8;
constexpr std::size_t kUpdates = 64;

LiveUpdate add(Slam& slam, LiveScan scan) {
  LiveUpdate out;
  out.update = slam.add(scan.measurement);
  out.confidence = is_tracked(out.update.status) ? out.update.diagnostics.overlap : 0.0;
  out.latency_ms = 1e-6 * static_cast<double>(steady_ns() - scan.arrived_ns);
  out.measurement = std::make_shared<const RangeMeasurement>(std::move(scan.measurement));
  out.map = slam.map();
  return out;
}

}  // namespace

LiveSummary run_live(LiveSource& source, Slam& slam, const std::function<bool()>& stop,
                     const std::function<void(const LiveUpdate&)>& sink,
                     const std::function<void(const std::string&)>& tell, const std::function<void(Slam&)>& between) {
  BoundedQueue<LiveScan> scans(kScans);
  BoundedQueue<LiveUpdate> updates(kUpdates);
  std::exception_ptr failure;
  std::mutex failing;
  const auto guarded = [&](const auto& work) {
    try {
      work();
    } catch (...) {
      const std::lock_guard lock(failing);
      if (!failure) failure = std::current_exception();
    }
  };
  const auto failed = [&] {
    const std::lock_guard lock(failing);
    return failure != nullptr;
  };
  LiveSummary summary;
  std::thread mapping([&] {
    guarded([&] {
      while (auto scan = scans.pop()) {
        LiveUpdate update = add(slam, std::move(*scan));
        update.dropped = scans.dropped();
        ++summary.scans;
        summary.worst_latency_ms = std::max(summary.worst_latency_ms, update.latency_ms);
        updates.push(std::move(update));
        if (between && scans.empty()) between(slam);
      }
    });
    updates.close();
  });
  std::thread showing([&] {
    guarded([&] {
      while (const auto update = updates.pop()) sink(*update);
    });
  });
  guarded([&] {
    source.run([&] { return stop() || failed(); }, [&](LiveScan scan) { scans.push(std::move(scan)); }, tell);
  });
  scans.close();
  mapping.join();
  showing.join();
  summary.dropped = scans.dropped();
  if (failure) std::rethrow_exception(failure);
  return summary;
}

}  // namespace phasescan::live
