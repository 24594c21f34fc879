/// What spectrum/fft.cpp needs of an FFT library; one .cpp per library implements it.
#pragma once

#include <complex>
#include <cstddef>
#include <memory>

namespace phasescan {

struct FftShape {
  int rows = 0;
  int cols = 0;
  bool two_dimensional = true;  ///< false: every row is transformed on its own

  std::size_t real_size() const { return static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols); }
  std::size_t complex_size() const { return static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols / 2 + 1); }
};

/// @throws std::invalid_argument
FftShape checked_shape(int rows, int cols, bool two_dimensional);

/// Unscaled transforms of one shape.
class FftBackend {
 public:
  explicit FftBackend(const FftShape& shape);
  FftBackend(FftBackend&&) noexcept;
  FftBackend& operator=(FftBackend&&) noexcept;
  ~FftBackend();

  void forward(const float* in, std::complex<float>* out);
  void inverse(std::complex<float>* in, float* out);  ///< destroys `in`

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace phasescan
