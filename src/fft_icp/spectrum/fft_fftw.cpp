#ifdef PHASESCAN_FFT_FFTW
#include <fftw3.h>

#include <map>
#include <mutex>
#include <stdexcept>
#include <tuple>

#include "core/aligned.hpp"
#include "fft_icp/spectrum/fft_backend.hpp"

namespace phasescan {
namespace {

struct Plans {
  fftwf_plan forward;
  fftwf_plan inverse;
};

fftwf_complex* as_fftw(std::complex<float>* p) {
  return reinterpret_cast<fftwf_complex*>(p);
}

Plans make_plans(const FftShape& shape) {
  FloatBuffer real(shape.real_size());
  ComplexBuffer half(shape.complex_size());
  if (shape.two_dimensional) {
    return {fftwf_plan_dft_r2c_2d(shape.rows, shape.cols, real.data(), as_fftw(half.data()), FFTW_ESTIMATE),
            fftwf_plan_dft_c2r_2d(shape.rows, shape.cols, as_fftw(half.data()), real.data(), FFTW_ESTIMATE)};
  }
  const int n = shape.cols, half_n = n / 2 + 1;
  return {fftwf_plan_many_dft_r2c(1, &n, shape.rows, real.data(), nullptr, 1, n, as_fftw(half.data()), nullptr, 1,
                                  half_n, FFTW_ESTIMATE),
          fftwf_plan_many_dft_c2r(1, &n, shape.rows, as_fftw(half.data()), nullptr, 1, half_n, real.data(), nullptr, 1,
                                  n, FFTW_ESTIMATE | FFTW_DESTROY_INPUT)};
}

/// Plans by shape, made once and kept to the end of the process: FFTW's planner is not thread-safe, executing is.
const Plans& cached_plans(const FftShape& shape) {
  static std::mutex mutex;
  static std::map<std::tuple<int, int, bool>, Plans> cache;
  const std::lock_guard<std::mutex> lock(mutex);
  const std::tuple<int, int, bool> key{shape.rows, shape.cols, shape.two_dimensional};
  const auto found = cache.find(key);
  if (found != cache.end()) return found->second;
  const Plans plans = make_plans(shape);
  if (plans.forward == nullptr || plans.inverse == nullptr) throw std::runtime_error("fft: FFTW made no plan");
  return cache.emplace(key, plans).first->second;
}

}  // namespace

struct FftBackend::Impl {
  const Plans& plans;
};

FftBackend::FftBackend(const FftShape& shape) : impl_(new Impl{cached_plans(shape)}) {}
FftBackend::FftBackend(FftBackend&&) noexcept = default;
FftBackend& FftBackend::operator=(FftBackend&&) noexcept = default;
FftBackend::~FftBackend() = default;

void FftBackend::forward(const float* in, std::complex<float>* out) {
  // An out-of-place real-to-complex transform leaves its input alone.
  fftwf_execute_dft_r2c(impl_->plans.forward, const_cast<float*>(in), as_fftw(out));
}

void FftBackend::inverse(std::complex<float>* in, float* out) {
  fftwf_execute_dft_c2r(impl_->plans.inverse, as_fftw(in), out);
}

}  // namespace phasescan
#endif
