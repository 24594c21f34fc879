/// Owning two-dimensional float image.
#pragma once

#include <algorithm>
#include <cstddef>

#include "core/aligned.hpp"

namespace phasescan {

/// Row-major image: row = y, column = x, both growing with their coordinate (row 0 is the lowest y, not the top).
class Image {
 public:
  Image() = default;
  Image(int rows, int cols) { resize(rows, cols); }

  /// Sets the shape and clears to 0. Allocates only while the image grows.
  void resize(int rows, int cols) {
    rows_ = rows;
    cols_ = cols;
    pixels_.assign(static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols), 0.0F);
  }

  int rows() const { return rows_; }
  int cols() const { return cols_; }
  float& at(int row, int col) { return pixels_[offset(row, col)]; }
  float at(int row, int col) const { return pixels_[offset(row, col)]; }
  float* row(int r) { return pixels_.data() + offset(r, 0); }
  const float* row(int r) const { return pixels_.data() + offset(r, 0); }
  FloatBuffer& pixels() { return pixels_; }
  const FloatBuffer& pixels() const { return pixels_; }

 private:
  std::size_t offset(int row, int col) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(cols_) + static_cast<std::size_t>(col);
  }

  int rows_ = 0;
  int cols_ = 0;
  FloatBuffer pixels_;
};

}  // namespace phasescan
