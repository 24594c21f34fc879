/// All places seen, searched by their descriptors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "slam/place_descriptor.hpp"

namespace phasescan {

struct PlaceHit {
  std::uint32_t place = 0;
  std::uint32_t distance = 0;  ///< sum of squared differences of `numbers`
  std::int32_t likeness = 0;   ///< the higher the more alike; 0 where it was not asked for
};

/// How well the turning parts of two descriptors agree at the turn at which they agree most; integer arithmetic, the
/// same on every machine.
/// @return  127 times the correlation of the four-bit numbers, the real part; about 500,000 of a descriptor with itself
std::int32_t turned_likeness(const PlaceDescriptor& a, const PlaceDescriptor& b);

/// Brute force over 324 bytes a place: 160 numbers that do not turn are read in one sweep of inner products, the
/// turning ones only of the places that are then nearest. A plain value: what `visit` names is all there is.
class PlaceIndex {
 public:
  static constexpr int kVersion = 1;
  /// @return the number of the place, counting from 0
  std::uint32_t add(const PlaceDescriptor& descriptor);
  /// Takes the places of another index in after its own.
  void append(const PlaceIndex& other);
  /// The `count` nearest of the first `limit` places (all where limit is 0) by the numbers that do not turn, nearest
  /// first; earlier ones first among equals.
  std::vector<PlaceHit> nearest(const PlaceDescriptor& query, std::size_t count, std::size_t limit = 0) const;
  /// The `count` places most like the query, best first: of n places the sqrt(n) nearest, 32 at least, are compared
  /// over all turns as well, which tells apart places whose walls have the same lengths but not the same angles between
  /// them.
  /// @cost  3 ns a place and 0.15 us a place compared over all turns
  std::vector<PlaceHit> most_alike(const PlaceDescriptor& query, std::size_t count, std::size_t limit = 0) const;
  std::size_t size() const { return squares_.size(); }
  /// Whether it has as many numbers as places: of what was read from a file.
  bool is_sound() const {
    return numbers_.size() == kDescriptorSize * squares_.size() && turning_.size() == kTurningSize * squares_.size();
  }

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("numbers", self.numbers_);
    v("turning", self.turning_);
    v("squares", self.squares_);
  }

 private:
  /// The `count` nearest of the first n places, in no order.
  std::vector<PlaceHit> shortlist(const PlaceDescriptor& query, std::size_t count, std::size_t n) const;

  std::vector<std::int8_t> numbers_;
  std::vector<std::uint8_t> turning_;
  std::vector<std::int32_t> squares_;  // of the numbers, summed
};

}  // namespace phasescan
