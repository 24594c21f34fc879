// How far a command is, on stderr, for somebody who waits: on a terminal only.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace phasescan {
class LogReader;
}

namespace phasescan::app {

/// "12 s", "3 min", "1 h 05 min".
std::string duration_text(double seconds);

/// A line that is written over and over, at most ten times a second; gone when the object is. Where the length of the
/// work is known: a bar and the time left at the speed so far. Else a count and how many there were per second.
class Progress {
 public:
  /// `total` 0: unknown.
  Progress(std::string what, std::size_t total);
  /// Of a log, whose share that has been read is known where it is a file; `log` must outlive it.
  Progress(std::string what, const LogReader& log);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void step(std::size_t done);
  /// Takes the line away: something else is to be written.
  void end();

 private:
  void show(std::size_t done, std::optional<double> share);

  std::string what_;
  std::size_t total_ = 0;
  const LogReader* log_ = nullptr;
  bool on_terminal_, written_ = false;
  double start_, next_;  // [s] of the steady clock
};

}  // namespace phasescan::app
