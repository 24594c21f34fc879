/// A fuzzer's input as a file in memory: the readers open files, and see what a user would give them.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "phasescan/io/error.hpp"
#include "phasescan/io/log.hpp"

namespace phasescan::fuzz {

class MemoryFile {
 public:
  MemoryFile(const std::uint8_t* data, std::size_t size) : fd_(::memfd_create("phasescan-fuzz", 0)) {
    if (fd_ < 0 || ::write(fd_, data, size) != static_cast<ssize_t>(size)) throw std::runtime_error("no memory file");
    path_ = "/proc/self/fd/" + std::to_string(fd_);
  }
  ~MemoryFile() { ::close(fd_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  int fd_;
  std::string path_;
};

/// Reads a log to its end. What it may throw is what a user is told; anything else is a finding.
inline void read_log(const std::string& path, const LogOptions& options = {}) {
  try {
    const auto log = open_log(path, options);
    while (const auto entry = log->next()) {
      const Scan& scan = entry->scan;
      if (scan.states.size() != scan.ranges.size()) __builtin_trap();
      for (std::size_t i = 0; i < scan.size(); ++i) {
        if (scan.is_hit(i) != (scan.ranges[i] > 0.0F && scan.ranges[i] < 1e30F * 1e8F)) __builtin_trap();
      }
      if (entry->odometry && !entry->odometry->is_finite()) __builtin_trap();
    }
    static_cast<void>(log->facts());
  } catch (const InputError&) {
  }
}

}  // namespace phasescan::fuzz
