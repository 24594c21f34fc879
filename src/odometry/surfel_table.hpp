/// Which surfel belongs to a cell and direction, while a map is being made.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace phasescan {

/// A hash table with open addressing from 64-bit keys to indices. It holds what it is asked for: an unknown key gets
/// -1. Kept between maps: clearing it costs one pass over its slots.
class SurfelTable {
 public:
  void clear();
  /// The index of `key`, to be read or set; -1 for a new one. Valid until the next call.
  std::int32_t& at(std::uint64_t key);
  /// The same, fast where `key` is the one of the call before: hits of one scan lie next to each other. A copy.
  std::int32_t last(std::uint64_t key) const { return last_index_ >= 0 && key == last_key_ ? last_index_ : -1; }
  void remember(std::uint64_t key, std::int32_t index) { last_key_ = key, last_index_ = index; }
  /// Makes room where more than a quarter of the slots is taken by `entries` surfels (each takes up to two).
  void reserve(std::size_t entries);

 private:
  struct Slot {
    std::uint64_t key = 0;
    std::int32_t index = -1;
  };
  std::vector<Slot> slots_;
  std::uint64_t last_key_ = 0;
  std::int32_t last_index_ = -1;
};

}  // namespace phasescan
