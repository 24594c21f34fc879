/// All places seen, searched by their descriptors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "phasescan/slam/place_descriptor.hpp"

namespace phasescan {

struct PlaceHit {
  std::uint32_t place = 0;
  std::uint32_t distance = 0;  ///< sum of squared differences
};

/// Brute force over 8-bit descriptors: 160 bytes a place, read in one sweep of inner products.
class PlaceIndex {
 public:
  /// @return the number of the place, counting from 0
  std::uint32_t add(const PlaceDescriptor& descriptor);
  /// The `count` nearest of the first `limit` places (all where limit is 0), nearest first; earlier ones first among
  /// equals.
  std::vector<PlaceHit> nearest(const PlaceDescriptor& query, std::size_t count, std::size_t limit = 0) const;
  std::size_t size() const { return squares_.size(); }

 private:
  std::vector<std::int8_t> descriptors_;
  std::vector<std::int32_t> squares_;  // of each descriptor, summed
};

}  // namespace phasescan
