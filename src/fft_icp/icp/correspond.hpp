/// Nearest neighbours among the points of a scan (k-d tree).
#pragma once

#include <memory>

#include "scan/points.hpp"

namespace phasescan {

/// The two points nearest to a query; `index` is -1 where the set is empty, `second_distance` infinite with one point.
struct NearestPair {
  int index = -1;
  float distance = 0.0F;         ///< [m] to points[index]
  float second_distance = 0.0F;  ///< [m] to the next nearest point
};

/// A k-d tree over scan points. Immutable after `build`: any number of threads may ask at the same time.
class PointIndex {
 public:
  PointIndex();
  ~PointIndex();
  PointIndex(PointIndex&&) noexcept;
  PointIndex& operator=(PointIndex&&) noexcept;

  /// Indexes a copy of the points' x and y. @cost O(n log n), allocates.
  void build(const ScanPoints& points);

  std::size_t size() const;
  float x(int index) const;
  float y(int index) const;

  /// @cost O(log n), allocates nothing.
  NearestPair nearest(float x, float y) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace phasescan
