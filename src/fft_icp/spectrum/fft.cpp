#include "fft_icp/spectrum/fft.hpp"

#include <stdexcept>
#include <string>

#include "fft_icp/spectrum/fft_backend.hpp"

namespace phasescan {

struct RealFft::Impl {
  FftShape shape;
  FftBackend backend;
};

RealFft::RealFft(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
RealFft::RealFft(RealFft&&) noexcept = default;
RealFft& RealFft::operator=(RealFft&&) noexcept = default;
RealFft::~RealFft() = default;

RealFft RealFft::image(int rows, int cols) {
  const FftShape shape = checked_shape(rows, cols, true);
  return RealFft(std::unique_ptr<Impl>(new Impl{shape, FftBackend(shape)}));
}

RealFft RealFft::rows(int count, int length) {
  const FftShape shape = checked_shape(count, length, false);
  return RealFft(std::unique_ptr<Impl>(new Impl{shape, FftBackend(shape)}));
}

std::size_t RealFft::real_size() const {
  return impl_->shape.real_size();
}
std::size_t RealFft::complex_size() const {
  return impl_->shape.complex_size();
}

void RealFft::forward(const FloatBuffer& in, ComplexBuffer& out) {
  if (in.size() != real_size()) throw std::invalid_argument("fft.forward: " + std::to_string(in.size()) + " samples");
  out.resize(complex_size());
  impl_->backend.forward(in.data(), out.data());
}

void RealFft::inverse(ComplexBuffer& in, FloatBuffer& out) {
  if (in.size() != complex_size()) throw std::invalid_argument("fft.inverse: " + std::to_string(in.size()) + " values");
  out.resize(real_size());
  impl_->backend.inverse(in.data(), out.data());
  const FftShape& shape = impl_->shape;
  const float scale = 1.0F / static_cast<float>(shape.two_dimensional ? shape.rows * shape.cols : shape.cols);
  for (float& value : out) value *= scale;
}

FftShape checked_shape(int rows, int cols, bool two_dimensional) {
  if (rows < 1 || cols < 2 || cols % 2 != 0) {
    throw std::invalid_argument("fft: shape " + std::to_string(rows) + " x " + std::to_string(cols) +
                                "; columns must be even, rows 1 or more");
  }
  return {rows, cols, two_dimensional};
}

}  // namespace phasescan
