#ifdef PHASESCAN_FFT_KISS
#include <kiss_fft.h>
#include <kiss_fftr.h>

#include <stdexcept>
#include <vector>

#include "fft_icp/spectrum/fft_backend.hpp"

namespace phasescan {
namespace {

struct FreeKiss {
  void operator()(void* p) const { KISS_FFT_FREE(p); }
};
template <class T>
using KissPtr = std::unique_ptr<T, FreeKiss>;

template <class T>
KissPtr<T> checked(T* plan) {
  if (plan == nullptr) throw std::runtime_error("fft: KissFFT made no plan");
  return KissPtr<T>(plan);
}

}  // namespace

struct FftBackend::Impl {
  explicit Impl(const FftShape& s)
      : shape(s),
        row_forward(checked(kiss_fftr_alloc(s.cols, 0, nullptr, nullptr))),
        row_inverse(checked(kiss_fftr_alloc(s.cols, 1, nullptr, nullptr))),
        column_forward(checked(kiss_fft_alloc(s.rows, 0, nullptr, nullptr))),
        column_inverse(checked(kiss_fft_alloc(s.rows, 1, nullptr, nullptr))),
        column(static_cast<std::size_t>(s.rows)) {}

  int half() const { return shape.cols / 2 + 1; }

  /// Transforms every column of a half spectrum in place.
  void transform_columns(kiss_fft_cfg plan, std::complex<float>* data) {
    auto* values = reinterpret_cast<kiss_fft_cpx*>(data);
    for (int u = 0; u < half(); ++u) {
      kiss_fft_stride(plan, values + u, column.data(), half());
      for (int v = 0; v < shape.rows; ++v) values[v * half() + u] = column[static_cast<std::size_t>(v)];
    }
  }

  FftShape shape;
  KissPtr<kiss_fftr_state> row_forward, row_inverse;
  KissPtr<kiss_fft_state> column_forward, column_inverse;
  std::vector<kiss_fft_cpx> column;
};

FftBackend::FftBackend(const FftShape& shape) : impl_(std::make_unique<Impl>(shape)) {}
FftBackend::FftBackend(FftBackend&&) noexcept = default;
FftBackend& FftBackend::operator=(FftBackend&&) noexcept = default;
FftBackend::~FftBackend() = default;

void FftBackend::forward(const float* in, std::complex<float>* out) {
  auto* values = reinterpret_cast<kiss_fft_cpx*>(out);
  for (int r = 0; r < impl_->shape.rows; ++r) {
    kiss_fftr(impl_->row_forward.get(), in + r * impl_->shape.cols, values + r * impl_->half());
  }
  if (impl_->shape.two_dimensional) impl_->transform_columns(impl_->column_forward.get(), out);
}

void FftBackend::inverse(std::complex<float>* in, float* out) {
  if (impl_->shape.two_dimensional) impl_->transform_columns(impl_->column_inverse.get(), in);
  const auto* values = reinterpret_cast<const kiss_fft_cpx*>(in);
  for (int r = 0; r < impl_->shape.rows; ++r) {
    kiss_fftri(impl_->row_inverse.get(), values + r * impl_->half(), out + r * impl_->shape.cols);
  }
}

}  // namespace phasescan
#endif
