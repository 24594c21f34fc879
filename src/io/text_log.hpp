// What line-based log readers share: lines one by one, bad ones recorded as damage, broken packing as the end.
#pragma once

#include <string>

#include "phasescan/io/error.hpp"
#include "io/file.hpp"
#include "io/log_input.hpp"
#include "phasescan/io/log.hpp"

namespace phasescan {

/// A LogReader over the lines of a text file. Derived classes read entries from `next_line` and call `damage_here` for
/// what they cannot read.
class TextLogReader : public LogReader {
 public:
  explicit TextLogReader(LogInput& input)
      : lines_(InputStream(input.name(), std::make_unique<StreamSource>(input.take()))) {}

 protected:
  /// The next line that is not blank; false at the end, which broken gzip data is too (recorded).
  bool next_line(std::string& line) {
    if (ended_) return false;
    try {
      do {
        if (!lines_.next(line)) {
          ended_ = true;
          return false;
        }
      } while (line.find_first_not_of(" \t") == std::string::npos);
      return true;
    } catch (const InputError& error) {
      ended_ = true;
      add_damage("broken data", error.what());
      return false;
    }
  }

  /// Records that the current line cannot be read. A last line without its newline counts as cut off.
  void damage_here(const std::string& kind, const std::string& reason) {
    const InputError place(path(), line_number(), reason);
    add_damage(lines_.line_was_ended() ? kind : "truncated line", place.what());
  }

  bool line_was_ended() const { return lines_.line_was_ended(); }
  long line_number() const { return lines_.line_number(); }
  const std::string& path() const { return lines_.path(); }

 private:
  LineReader lines_;
  bool ended_ = false;
};

}  // namespace phasescan
