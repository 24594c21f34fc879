/// Records of scans as a run of days holds them: nothing changes them any more, and nobody asks for them before its
/// end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "slam/scan_ledger.hpp"

namespace phasescan {

/// Some 17 bytes a record instead of 32, and no buffer that is outgrown. Nothing is lost: what comes out is what went
/// in.
class PackedRecords {
 public:
  void add(std::span<const ScanRecord> records);
  void clear();
  std::size_t size() const { return size_; }
  /// @cost O(size)
  std::vector<ScanRecord> records() const;

 private:
  std::vector<std::vector<std::uint8_t>> chunks_;  // what each `add` brought, decoded by itself
  std::size_t size_ = 0;
};

}  // namespace phasescan
