// What who called `live` sees of a run.
#pragma once

#include <map>
#include <string>

#include "phasescan/live/live.hpp"

namespace phasescan::app {

/// A line per scan with --json, else one that changes on a terminal, else one per event. Warnings of the run go to
/// stderr; one kind, the words before the colon, at most once in a minute of stamps, with how many were held back.
class LiveOutput final : public live::LiveSink {
 public:
  explicit LiveOutput(bool json);
  void take(const live::LiveUpdate& update) override;
  /// A line for people; by any thread.
  void tell(const std::string& text) const;
  void end() const;

 private:
  struct Told {
    Stamp at = 0;
    int held_back = 0;
  };
  void warn(const std::string& text, Stamp stamp);

  bool json_, terminal_;
  std::string before_;
  std::map<std::string, Told> told_;  // by kind
};

}  // namespace phasescan::app
