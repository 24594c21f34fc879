/// Pairs files: JSON Lines of two scans and, where known, the true pose between them (CONTRACT: pairs file). Simulated
/// ones have two fields more, which are optional: "overlap" (0..1) and "information" (9 numbers, row-major, x y theta).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "io/file.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan {

/// One line of a pairs file.
struct ScanPair {
  std::string id;
  std::string dataset;
  std::string cls;  ///< small, middle, large, global, none, or whatever the file says
  Scan reference;
  Scan scan;
  std::optional<Pose2> truth;     ///< T_ref_scan; empty for class none or where the file has no truth
  std::optional<double> overlap;  ///< share of the surface that both scans see, 0..1; simulated pairs know it
  std::optional<Eigen::Matrix3d>
      information;  ///< best possible, of (x, y, theta) in the reference frame; simulated pairs know it
};

/// What one line of a pairs file gave: a pair, or why there is none.
struct PairLine {
  long line = 0;  ///< 1-based
  std::optional<ScanPair> pair;
  std::string error;  ///< empty with a pair; else what is wrong and what was expected, without the place
};

/// Reads a pairs file, plain or .gz, front to back in bounded memory. Blank lines are passed over.
class PairReader {
 public:
  explicit PairReader(const std::string& path);

  /// The next line, or nothing at the end. A bad line is an answer, and the rest goes on; data that cannot be unpacked
  /// any further is one bad line, and the last. @throws InputError at the end of a file that holds no line at all.
  std::optional<PairLine> next();

  const std::string& path() const { return lines_.path(); }

 private:
  LineReader lines_;
  std::string text_;
  bool any_ = false;
  bool ended_ = false;
};

/// All pairs of a file. @throws InputError at the first bad line.
std::vector<ScanPair> read_pairs(const std::string& path);

/// One pair as one line of JSON without newline; scans as `format_scan_json`.
std::string format_pair(const ScanPair& pair);

/// Writes pairs files (.gz by name); whole or not at all.
class PairWriter {
 public:
  explicit PairWriter(const std::string& path) : file_(path) {}
  void write(const ScanPair& pair) { file_.write(format_pair(pair) + "\n"); }
  void commit() { file_.commit(); }

 private:
  AtomicFile file_;
};

}  // namespace phasescan
