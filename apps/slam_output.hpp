// The files that `phasescan slam` leaves in its folder.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "io/file.hpp"
#include "io/odometry_source.hpp"
#include "phasescan/slam/slam.hpp"
#include "report/map_viewer.hpp"

namespace phasescan::app {

/// One log of a run, or a part of one that was stopped.
struct SlamInput {
  std::string log;                                ///< as it was named
  std::int64_t first_scan = 0, scans = 0;         ///< of the run
  std::int32_t session = 0;                       ///< which drive it belongs to
  std::uint64_t first_print = 0, last_print = 0;  ///< of its first and its last scan, by which it is known again
  std::vector<std::int64_t> lines;                ///< of its scans
  std::map<std::string, std::size_t> damages;     ///< of the reader, by kind
  std::uint64_t tracked = 0, usable = 0, new_segments = 0;
  std::string state;  ///< the saved run that it came with, where several were merged; not saved

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("log", self.log);
    v("first_scan", self.first_scan);
    v("scans", self.scans);
    v("session", self.session);
    v("first_print", self.first_print);
    v("last_print", self.last_print);
    v("lines", self.lines);
    v("damages", self.damages);
    v("tracked", self.tracked);
    v("usable", self.usable);
    v("new_segments", self.new_segments);
  }
};

/// What a run knows beside its result.
struct SlamRun {
  static constexpr int kVersion = 1;
  std::vector<SlamInput> inputs;  ///< in the order in which they were read
  std::string reading;            ///< flags by which scans are cut down
  OdometryJudge judge;            ///< of the log that may go on
  OdometrySource source;          ///< of the first drive
  Stamp last_stamp = 0;           ///< of the scan read last
  std::string log;
  std::string format;
  std::string odometry_assumed;
  bool odometry_used = false;
  bool complete = true;  ///< false: stopped by the user
  bool times = true;
  bool glass_blocks = true;        ///< sure glass is occupied in map.pgm
  bool deskew_asked = true;        ///< by the options
  std::vector<float> cpu_ms;       ///< tracker's thread, per scan
  std::vector<float> tracking_ms;  ///< the same without loops and graph
  std::vector<float> wall_ms;
  std::vector<float> overlap;
  ShownScans shown;
  std::size_t tracked = 0, searched = 0, caught = 0, new_segments = 0, usable = 0;
  double total_cpu_s = 0.0, total_wall_s = 0.0;
  std::map<std::string, std::size_t> damages;     ///< of the reader, by kind
  std::map<std::string, std::string> first_seen;  ///< of each oddity of the scans: "FILE:LINE: what"
  Pose2 T_base_laser;                             ///< of the first scan
  bool flipped = false;                           ///< that laser is mounted upside down

  /// Names what a saved run keeps of it.
  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("inputs", self.inputs);
    v("reading", self.reading);
    v("judge", self.judge);
    v("source_usable", self.source.usable);
    v("source_assumed", self.source.assumed);
    v("last_stamp", self.last_stamp);
    v("log", self.log);
    v("format", self.format);
    v("overlap", self.overlap);
    v("shown", self.shown);
    v("tracked", self.tracked);
    v("searched", self.searched);
    v("caught", self.caught);
    v("new_segments", self.new_segments);
    v("usable", self.usable);
    v("first_seen", self.first_seen);
    v("T_base_laser", self.T_base_laser);
    v("flipped", self.flipped);
  }
};

/// trajectory.tum, scans.jsonl, map.pgm, map.yaml, map.png, graph.g2o, report.html, summary.json and, with times,
/// timing.json: written, not yet in place. Without times, timing.json of an earlier run goes when they are.
/// @throws SystemError
FileSet slam_output(const std::string& folder, const SlamResult& result, const SlamRun& run);

/// Where nothing ties some drives to others: FOLDER/1, FOLDER/2, ..., each with all the files of a result, in place.
/// What an earlier run left in more of such folders goes. @throws SystemError
void write_parts(const std::string& folder, const SlamResult& result, const SlamRun& run);

/// "doubtful: kind: what": the verdict with its strongest reason, where it has one.
std::string verdict_text(const SlamResult& result);

}  // namespace phasescan::app
