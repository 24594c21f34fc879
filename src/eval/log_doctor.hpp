/// What is wrong with a log, what it means for a map, and what to do about it.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "phasescan/io/log.hpp"

namespace phasescan {

/// One finding of the doctor.
struct Finding {
  std::string kind;     ///< short, fixed name: "stamps backwards"
  std::string seen;     ///< what was counted
  std::string meaning;  ///< what it does to matching or mapping
  std::string advice;   ///< what to do
};

/// Looks at a log scan by scan; memory is bounded by the beams of one scan. Motion is judged by matching: turns and
/// paths of up to 240 pairs of scans, spread over the log by doubling the distance between them.
/// @cost about a match per scan at the beginning of a log, ever fewer later
class LogDoctor {
 public:
  LogDoctor();
  ~LogDoctor();

  void add(const LogEntry& entry);
  /// In a fixed order. `facts` and `remarks` are the reader's: it knows of values that were read as unknown, and of
  /// what it assumed or left out.
  std::vector<Finding> findings(const std::map<std::string, std::string>& facts = {},
                                const std::vector<LogRemark>& remarks = {}) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace phasescan
