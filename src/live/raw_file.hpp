// What a sensor sent, with its times: for repeating a run, and for reports of what went wrong.
//
//   "phasescan raw 1 SENSOR\n", then pieces: u64 nanoseconds since the first, u32 size, bytes. Little endian.
// Replies to what was sent are in it; what was sent is not.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "io/file.hpp"
#include "live/port.hpp"
#include "phasescan/core/time.hpp"

namespace phasescan::live {

class RawWriter {
 public:
  RawWriter(const std::string& path, std::string_view sensor);
  void write(std::span<const std::uint8_t> bytes, Stamp now);
  void commit() { file_.commit(); }

 private:
  AtomicFile file_;
  std::optional<Stamp> first_;
};

/// The sensor's name, where a file is one; empty: it is not.
std::string raw_sensor(const std::string& path);

/// Reads at the pace of its times. A file without them, as `cat` writes it, goes at `bytes_per_s`.
std::unique_ptr<Port> open_raw(const std::string& path, double bytes_per_s);

}  // namespace phasescan::live
