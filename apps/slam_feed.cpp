#include "slam_feed.hpp"

#include <chrono>
#include <cstring>
#include <filesystem>
#include <utility>

#include "commands.hpp"
#include "io/file.hpp"
#include "io/odometry_source.hpp"
#include "phasescan/core/time.hpp"
#include "phasescan/io/error.hpp"

namespace phasescan::app {
namespace {

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// FNV-1a of a scan as it was read: its stamp and its ranges, bit for bit.
std::uint64_t print_of(const Scan& scan) {
  std::uint64_t hash = 14695981039346656037U;
  const auto add = [&hash](std::uint64_t value) { hash = (hash ^ value) * 1099511628211U; };
  add(static_cast<std::uint64_t>(scan.stamp));
  for (std::size_t i = 0; i < scan.size(); ++i) {
    std::uint32_t bits = 0;
    if (scan.is_hit(i)) std::memcpy(&bits, &scan.ranges[i], sizeof(bits));
    add(bits);
  }
  return hash;
}

}  // namespace

/// Keeps where each kind of oddity was first seen.
class SlamFeed::Warnings final : public SlamObserver {
 public:
  explicit Warnings(SlamRun& run) : run_(run) {}
  void on_warning(ScanId scan, const std::string& kind, const std::string& what, bool) override {
    for (const SlamInput& input : run_.inputs) {
      const auto at = static_cast<std::size_t>(scan - input.first_scan);
      if (scan < input.first_scan || at >= input.lines.size()) continue;
      run_.first_seen.emplace(kind, input.log + ":" + std::to_string(input.lines[at]) + ": " + what);
    }
  }

 private:
  SlamRun& run_;
};

SlamFeed::SlamFeed(Slam& slam, SlamRun& run, StateSaver& saver, SlamRecording* recording, const FeedSettings& settings)
    : slam_(slam), run_(run), saver_(saver), recording_(recording), settings_(settings) {}

std::size_t SlamFeed::known_input(const LogEntry& first) const {
  if (settings_.first == Joining::kNewDrive) return run_.inputs.size();
  const std::uint64_t print = print_of(first.scan);
  for (std::size_t i = cursor_; i < run_.inputs.size(); ++i) {
    if (run_.inputs[i].scans > 0 && run_.inputs[i].first_print == print) return i;
  }
  return run_.inputs.size();
}

bool SlamFeed::goes_on(const LogEntry& first) const {
  if (run_.inputs.empty()) return true;
  if (logs_ == 0) return settings_.first == Joining::kGoesOn;
  const double gap_s = stamp_to_seconds(first.scan.stamp - run_.last_stamp);
  return gap_s >= 0.0 && gap_s <= settings_.session_gap_s;
}

bool SlamFeed::read(LogReader& reader, const std::string& log) {
  std::optional<LogEntry> first = reader.next();
  if (!first) {
    JudgedLog nothing(reader);
    if (!run_.inputs.empty()) warn(log + ": holds no scan");
    return true;
  }
  const std::size_t known = known_input(*first);
  if (known < run_.inputs.size()) {
    cursor_ = known + 1;
    ++logs_;
    if (cursor_ < run_.inputs.size()) return true;  // the run went on with another log after it
    JudgedLog judged(reader, true, {}, std::move(first));
    return pass_over(judged, reader, run_.inputs[known]);
  }
  const bool on = goes_on(*first);
  if (!on) slam_.begin_session();
  ++logs_;
  cursor_ = run_.inputs.size() + 1;
  SlamInput input;
  input.log = log;
  input.first_scan = static_cast<std::int64_t>(slam_.scans());
  input.session = run_.inputs.empty() ? 0 : run_.inputs.back().session + (on ? 0 : 1);
  input.first_print = print_of(first->scan);
  if (run_.inputs.empty()) run_.log = log, run_.format = reader.format();
  run_.inputs.push_back(std::move(input));
  JudgedLog judged(reader, true, on ? run_.judge : OdometryJudge{}, std::move(first));
  return pass_over(judged, reader, run_.inputs.back());
}

/// The scans that the run has, and then those that it has not.
bool SlamFeed::pass_over(JudgedLog& log, LogReader& reader, const SlamInput& input) {
  Progress progress("slam", reader);
  Warnings warnings(run_);
  slam_.set_observer(&warnings);
  std::int64_t passed = 0;
  const std::int64_t known = input.scans;
  bool ended = false;
  while (!InterruptGuard::interrupted() && !ended) {
    std::optional<LogEntry> entry = log.next();
    if (!entry) {
      ended = true;
    } else if (passed < known) {
      if (++passed == known && print_of(entry->scan) != input.last_print) {
        throw InputError(
            input.log, entry->line,
            "begins like the log of the saved run, but is another one from here on; expected the same log, "
            "or one that follows it");
      }
      if (recording_ != nullptr) recording_->add(*entry);
    } else {
      add(std::move(*entry));
      progress.step(slam_.scans());
    }
  }
  slam_.set_observer(nullptr);
  progress.end();
  if (ended && passed < known) warn(input.log + ": holds fewer scans than the saved run has of it");
  end_input(log, reader);
  return ended;
}

void SlamFeed::add(LogEntry entry) {
  SlamInput& input = run_.inputs.back();
  if (slam_.scans() == 0) run_.T_base_laser = entry.T_base_laser, run_.flipped = entry.flipped;
  const std::uint64_t print = print_of(entry.scan);
  const std::int64_t line = entry.line;
  if (settings_.beam_step > 1) entry.scan = reduce_scan(entry.scan, 0.0, settings_.beam_step);
  if (recording_ != nullptr) recording_->add(entry);
  RangeMeasurement measurement = to_measurement(std::move(entry));
  if (!settings_.use_odometry) measurement.T_odom_base.reset();
  input.lines.push_back(line);
  ++input.scans;
  input.last_print = print;
  run_.last_stamp = measurement.scan.stamp;
  const double cpu = thread_cpu_seconds(), wall = wall_seconds();
  const ScanUpdate update = slam_.add(measurement);
  const double spent = thread_cpu_seconds() - cpu;
  run_.shown.add(slam_.scans() - 1, measurement.scan, measurement.T_base_laser);
  count(update, measurement.scan.hit_count() > 0);
  run_.cpu_ms.push_back(static_cast<float>(1e3 * spent));
  run_.tracking_ms.push_back(static_cast<float>(1e3 * (spent - slam_.last_backend_cpu_s())));
  run_.wall_ms.push_back(static_cast<float>(1e3 * (wall_seconds() - wall)));
  saver_.scan_added(slam_, run_);
}

void SlamFeed::count(const ScanUpdate& update, bool usable) {
  const TrackingDiagnostics& d = update.diagnostics;
  if (update.repeated) {
    run_.overlap.push_back(run_.overlap.empty() ? 0.0F : run_.overlap.back());
    return;
  }
  SlamInput& input = run_.inputs.back();
  run_.overlap.push_back(static_cast<float>(d.overlap));
  run_.tracked += is_tracked(update.status);
  run_.searched += d.wide_search;
  run_.caught += d.full_search;
  run_.new_segments += d.new_segment;
  run_.usable += usable;
  input.tracked += is_tracked(update.status);
  input.new_segments += d.new_segment;
  input.usable += usable;
}

/// What is known of a log once it is read.
void SlamFeed::end_input(const JudgedLog& log, const LogReader& reader) {
  SlamInput& input = run_.inputs.back();
  run_.judge = log.judge();
  if (input.session == 0) run_.source = log.source();
  input.damages.clear();
  for (const LogDamage& damage : reader.damages()) ++input.damages[damage.kind];
  if (reader.damage_count() > reader.damages().size())
    input.damages["further damage"] = reader.damage_count() - reader.damages().size();
}

}  // namespace phasescan::app
