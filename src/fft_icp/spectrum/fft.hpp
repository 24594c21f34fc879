/// The only door to the FFT library (FFTW single precision, or KissFFT): real transforms, forward and back.
#pragma once

#include <memory>

#include "core/aligned.hpp"

namespace phasescan {

/// A real FFT of a fixed shape.
///
/// F(v, u) = sum f(row, col) exp(-j 2 pi (u col / cols + v row / rows)), not scaled; the inverse scales by 1 / (number
/// of samples), here and nowhere else. Only columns 0 .. cols/2 of a spectrum are kept; the rest is its complex
/// conjugate. FFTW plans are made once per shape behind a mutex with ESTIMATE (MEASURE would let timing decide the
/// result) and shared by all objects and threads; KissFFT plans hold buffers and belong to their object. Executing
/// allocates nothing.
class RealFft {
 public:
  /// 2-D transform, rows x cols. @throws std::invalid_argument for an odd or too small `cols`, or `rows` < 1.
  static RealFft image(int rows, int cols);
  /// `count` independent 1-D transforms of `length`, one per row. @throws std::invalid_argument as above.
  static RealFft rows(int count, int length);

  RealFft(RealFft&&) noexcept;
  RealFft& operator=(RealFft&&) noexcept;
  ~RealFft();

  std::size_t real_size() const;
  std::size_t complex_size() const;

  /// @param in   real_size() samples, row-major
  /// @param out  resized to complex_size(): rows x (cols/2 + 1)
  void forward(const FloatBuffer& in, ComplexBuffer& out);
  /// @param in   complex_size() coefficients; destroyed
  /// @param out  resized to real_size(), scaled
  void inverse(ComplexBuffer& in, FloatBuffer& out);

 private:
  struct Impl;
  explicit RealFft(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace phasescan
