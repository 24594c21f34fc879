#include "odometry/surfel_table.hpp"

#include <algorithm>

namespace phasescan {
namespace {

constexpr std::uint64_t kEmpty = ~std::uint64_t{0};

std::uint64_t hash(std::uint64_t key) {
  key ^= key >> 31;
  key *= 0x9E3779B97F4A7C15ULL;
  return key ^ (key >> 29);
}

}  // namespace

void SurfelTable::clear() {
  last_index_ = -1;
  if (slots_.empty()) slots_.resize(4096);
  std::fill(slots_.begin(), slots_.end(), Slot{kEmpty, -1});
}

std::int32_t& SurfelTable::at(std::uint64_t key) {
  const std::size_t mask = slots_.size() - 1;
  std::size_t at = hash(key) & mask;
  while (slots_[at].key != kEmpty && slots_[at].key != key) at = (at + 1) & mask;
  slots_[at].key = key;
  return slots_[at].index;
}

void SurfelTable::reserve(std::size_t entries) {
  if (4 * entries <= slots_.size()) return;
  std::vector<Slot> old(2 * slots_.size(), Slot{kEmpty, -1});
  old.swap(slots_);
  for (const Slot& s : old) {
    if (s.key != kEmpty) at(s.key) = s.index;
  }
}

}  // namespace phasescan
