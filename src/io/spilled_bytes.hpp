/// Bytes that are only needed at the end, kept on the disk so that memory does not grow with them.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "io/bytes.hpp"

namespace phasescan {

/// In a file without a name: nothing of it stays, however the process ends. Where the folder has no such files, in
/// memory.
class SpilledBytes {
 public:
  /// @param folder  empty: in memory
  explicit SpilledBytes(const std::string& folder);
  ~SpilledBytes();
  SpilledBytes(SpilledBytes&& other) noexcept;
  SpilledBytes& operator=(SpilledBytes&&) = delete;

  /// @throws SystemError, e.g. disk full
  void add(Bytes bytes);
  std::uint64_t size() const { return on_disk_ + held_.size(); }
  /// All that was added, in pieces, in order. @throws SystemError
  void read(const std::function<void(Bytes piece)>& take);

 private:
  void flush();

  int fd_ = -1;
  std::uint64_t on_disk_ = 0;
  std::vector<std::uint8_t> held_;
};

}  // namespace phasescan
