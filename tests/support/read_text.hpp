/// A log that is a text, read to its end.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "phasescan/io/error.hpp"
#include "phasescan/io/log.hpp"
#include "support/temp.hpp"

namespace phasescan::test {

struct ReadText {
  std::vector<LogEntry> entries;
  std::vector<LogDamage> damages;
  std::vector<LogRemark> remarks;
  std::string format;

  bool has_remark(const std::string& kind) const {
    for (const LogRemark& remark : remarks) {
      if (remark.kind == kind) return true;
    }
    return false;
  }
};

inline ReadText read_log(const std::string& path, const LogOptions& options = {}) {
  const auto log = open_log(path, options);
  ReadText out;
  while (auto entry = log->next()) out.entries.push_back(std::move(*entry));
  out.damages = log->damages();
  out.remarks = log->remarks();
  out.format = log->format();
  return out;
}

inline ReadText read_text(const std::string& content, const LogOptions& options = {}) {
  const TempFolder folder;
  return read_log(folder.put("log", content), options);
}

/// What reading a text is refused with; empty where it is not.
inline std::string refusal_of(const std::string& content, const LogOptions& options = {}) {
  try {
    static_cast<void>(read_text(content, options));
  } catch (const InputError& error) {
    return error.reason();
  }
  return "";
}

}  // namespace phasescan::test
