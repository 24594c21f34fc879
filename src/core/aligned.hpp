/// Buffers aligned for SIMD and for FFT plans, which are only valid for memory of the alignment they were made for.
#pragma once

#include <complex>
#include <cstddef>
#include <new>
#include <vector>

namespace phasescan {

/// Allocator that aligns to a cache line.
template <class T>
struct AlignedAllocator {
  using value_type = T;
  static constexpr std::align_val_t kAlignment{64};

  AlignedAllocator() = default;
  template <class U>
  AlignedAllocator(const AlignedAllocator<U>&) {}

  T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), kAlignment)); }
  void deallocate(T* p, std::size_t) { ::operator delete(p, kAlignment); }
  template <class U>
  bool operator==(const AlignedAllocator<U>&) const {
    return true;
  }
};

using FloatBuffer = std::vector<float, AlignedAllocator<float>>;
using ComplexBuffer = std::vector<std::complex<float>, AlignedAllocator<std::complex<float>>>;

}  // namespace phasescan
