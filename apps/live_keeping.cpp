#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "commands.hpp"
#include "io/file.hpp"
#include "live_keeping.hpp"
#include "phasescan/core/time.hpp"
#include "phasescan/io/error.hpp"

namespace phasescan::app {
namespace {

/// A file that cannot be written is said now, not after an hour.
void check_writable(const std::string& path) {
  AtomicFile trial(path);
}

class ResumedSource final : public live::LiveSource {
 public:
  ResumedSource(std::unique_ptr<live::LiveSource> source, live::LiveEngine& engine, Stamp last, double session_gap_s)
      : source_(std::move(source)), engine_(engine), last_(last), session_gap_s_(session_gap_s) {}

  void run(const std::function<bool()>& stop, const std::function<void(live::LiveScan)>& hand,
           const std::function<void(const std::string&)>& tell) override {
    bool first = true;
    source_->run(
        stop,
        [&](live::LiveScan scan) {
          // The thread of SLAM does nothing before it is handed a scan.
          if (std::exchange(first, false)) join(scan.measurement.scan.stamp, tell);
          hand(std::move(scan));
        },
        tell);
  }
  bool can_wait() const override { return source_->can_wait(); }

 private:
  void join(Stamp stamp, const std::function<void(const std::string&)>& tell) {
    const double gap_s = stamp_to_seconds(stamp - last_);
    if (gap_s >= 0.0 && gap_s <= session_gap_s_) {
      tell(fmt::format("goes on {:.1f} s after the saved run", gap_s));
      return;
    }
    engine_.relocalise();
    tell("another drive than the saved one: it is tied to that map by what it sees again");
  }

  std::unique_ptr<live::LiveSource> source_;
  live::LiveEngine& engine_;
  Stamp last_;
  double session_gap_s_;
};

}  // namespace

void add_keeping_flags(CLI::App& command, KeepingFlags& flags) {
  command.add_option("--record", flags.record, "an MCAP of scans, poses, frames and map, readable while it grows")
      ->type_name("F.mcap")
      ->check(not_empty());
  command.add_option("--save", flags.save, "keep the run, every few seconds and at the end, to go on from")
      ->type_name("STATE")
      ->check(not_empty());
}

LiveKeeping::LiveKeeping(const KeepingFlags& flags, Slam* slam, double autosave_s, const Tell& tell)
    : slam_(slam), tell_(tell), save_(flags.save) {
  if (!save_.empty()) check_writable(save_);
  if (!flags.record.empty()) recorder_.emplace(flags.record, tell);
  if (!save_.empty()) state_.emplace(save_, autosave_s, tell);
}

void LiveKeeping::take(const live::LiveUpdate& update) {
  if (recorder_) recorder_->add(update);
}

void LiveKeeping::between() {
  if (state_ && slam_ != nullptr) state_->scan_added(*slam_);
}

bool LiveKeeping::finish() {
  bool whole = true;
  if (state_ && slam_ != nullptr && slam_->scans() > 0) {
    whole = state_->finish(*slam_);
    if (whole) tell_(save_ + ": the run is saved");
  }
  if (recorder_) {
    whole = recorder_->close() && whole;
    const live::RecorderCounts counts = recorder_->counts();
    tell_(fmt::format("{}: {} scans recorded, {:.2f} MB{}{}", recorder_->path(), counts.scans,
                      1e-6 * static_cast<double>(counts.bytes),
                      counts.dropped > 0 ? fmt::format(", {} left out: the disk is too slow", counts.dropped) : "",
                      counts.failed ? ", not to the end" : ""));
  }
  return whole;
}

std::unique_ptr<live::LiveSource> resumed(std::unique_ptr<live::LiveSource> source, live::LiveEngine& engine,
                                          Stamp last, double session_gap_s) {
  return std::make_unique<ResumedSource>(std::move(source), engine, last, session_gap_s);
}

}  // namespace phasescan::app
