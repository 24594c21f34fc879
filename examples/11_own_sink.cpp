// Poses into something of one's own: a sink with a thread and a bounded queue of its own. Here a CSV file, a line a
// scan, written while a log is replayed: LOG [POSES.csv].
#include <chrono>
#include <cstdio>
#include <exception>
#include <fstream>
#include <memory>
#include <phasescan/io/log.hpp>
#include <phasescan/live/live.hpp>
#include <phasescan/slam/slam.hpp>
#include <string>
#include <utility>

using namespace phasescan;

namespace {

class CsvSink : public live::LiveSink {
 public:
  explicit CsvSink(const std::string& path) : file_(path) { file_ << "stamp,status,x,y,theta,explained\n"; }

  void take(const live::LiveUpdate& update) override {
    const Pose2 pose = update.update.T_map_base();
    file_ << stamp_to_seconds(update.update.stamp) << ',' << to_string(update.update.status) << ',' << pose.x << ','
          << pose.y << ',' << pose.theta << ',' << update.confidence << '\n';
    ++lines_;
  }
  unsigned long long lines() const { return lines_; }

 private:
  std::ofstream file_;
  unsigned long long lines_ = 0;
};

// The scans of a log, as fast as they are used.
class LogSource : public live::LiveSource {
 public:
  explicit LogSource(const std::string& path) : log_(open_log(path)) {}
  void run(const std::function<bool()>& stop, const std::function<void(live::LiveScan)>& hand,
           const std::function<void(const std::string&)>&) override {
    while (!stop()) {
      auto entry = log_->next();
      if (!entry) return;
      const std::int64_t now = std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
      hand({.measurement = to_measurement(std::move(*entry)), .arrived_ns = now});
    }
  }
  bool can_wait() const override { return true; }

 private:
  std::unique_ptr<LogReader> log_;
};

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 2) {
    std::fprintf(stderr, "usage: %s LOG [POSES.csv]\n", argv[0]);
    return 2;
  }
  LogSource source(argv[1]);
  CsvSink sink(argc > 2 ? argv[2] : "poses.csv");
  Slam slam;
  const auto engine = live::slam_engine(slam, [] { return Slam(); });
  const live::LiveSummary summary = live::run_live(
      source, *engine, {&sink}, nullptr, [] { return false; }, [](const std::string&) {});
  std::printf("%llu scans, %llu lines, %llu left out\n", static_cast<unsigned long long>(summary.scans), sink.lines(),
              static_cast<unsigned long long>(summary.not_shown.at(0)));
  return summary.scans > 0 && sink.lines() + summary.not_shown.at(0) == summary.scans ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
