// What who called `live` sees of a run.
#pragma once

#include <string>

#include "phasescan/live/live.hpp"

namespace phasescan::app {

/// A line per scan with --json, else one that changes on a terminal, else one per event.
class LiveOutput final : public live::LiveSink {
 public:
  explicit LiveOutput(bool json);
  void take(const live::LiveUpdate& update) override;
  /// A line for people; by any thread.
  void tell(const std::string& text) const;
  void end() const;

 private:
  bool json_, terminal_;
  std::string before_;
};

}  // namespace phasescan::app
