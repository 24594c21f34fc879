// In the place of an FFT library, for programs that never transform: the kernels' test needs none on another machine.
#include <stdexcept>

#include "spectrum/fft_backend.hpp"

namespace phasescan {

struct FftBackend::Impl {};

FftBackend::FftBackend(const FftShape&) {
  throw std::logic_error("built without an FFT");
}
FftBackend::FftBackend(FftBackend&&) noexcept = default;
FftBackend& FftBackend::operator=(FftBackend&&) noexcept = default;
FftBackend::~FftBackend() = default;
void FftBackend::forward(const float*, std::complex<float>*) {}
void FftBackend::inverse(std::complex<float>*, float*) {}

}  // namespace phasescan
