// Logs into a run of SLAM, one after the other: where each goes on, and where a run that was saved goes on in its log.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "phasescan/io/log.hpp"
#include "phasescan/slam/slam.hpp"
#include "saved_run.hpp"
#include "slam_mcap.hpp"
#include "slam_output.hpp"

namespace phasescan::app {

/// How the first log stands to the run that was loaded.
enum class Joining { kGoesOn, kNewDrive };

struct FeedSettings {
  Joining first = Joining::kGoesOn;
  bool use_odometry = true;
  int beam_step = 1;
  double session_gap_s = 60.0;
};

/// Reads logs to their end or until the user stops it. What is counted goes to `run`.
class SlamFeed {
 public:
  SlamFeed(Slam& slam, SlamRun& run, StateSaver& saver, SlamRecording* recording, const FeedSettings& settings);

  /// The next log. Scans that the run has of it already are passed over.
  /// @return false where the user stopped it
  /// @throws InputError where it begins like a log of the run and goes on otherwise
  bool read(LogReader& reader, const std::string& log);

 private:
  class Warnings;

  std::size_t known_input(const LogEntry& first) const;
  bool pass_over(JudgedLog& log, LogReader& reader, const SlamInput& input);
  bool goes_on(const LogEntry& first) const;
  void add(LogEntry entry);
  void count(const ScanUpdate& update, bool usable);
  void end_input(const JudgedLog& log, const LogReader& reader);

  Slam& slam_;
  SlamRun& run_;
  StateSaver& saver_;
  SlamRecording* recording_;
  FeedSettings settings_;
  std::size_t logs_ = 0;
  std::size_t cursor_ = 0;  // inputs of the run before it were given again
};

}  // namespace phasescan::app
