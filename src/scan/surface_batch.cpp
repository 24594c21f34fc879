#include <algorithm>

#include "scan/surface.hpp"

namespace phasescan {

void SurfaceBatch::resize(std::size_t hits) {
  count = hits;
  const std::size_t size = (count + kPadding - 1) / kPadding * kPadding;
  for (auto* v : {&x, &y, &nx, &ny}) {
    v->resize(size);
    std::fill(v->begin() + static_cast<std::ptrdiff_t>(count), v->end(), 0.0F);
  }
  for (auto* v : {&length, &variance, &sigma}) {
    v->resize(size);
    std::fill(v->begin() + static_cast<std::ptrdiff_t>(count), v->end(), 1.0F);
  }
  weight.assign(size, 1.0F);
  std::fill(weight.begin() + static_cast<std::ptrdiff_t>(count), weight.end(), 0.0F);
}

void SurfaceBatch::put(std::size_t k, const SurfacePoint& point, float point_sigma) {
  x[k] = point.x;
  y[k] = point.y;
  nx[k] = point.nx;
  ny[k] = point.ny;
  length[k] = point.length;
  variance[k] = point.variance;
  sigma[k] = point_sigma;
}

void SurfaceBatch::fill(const SurfacePoints& surface, std::span<const int> indices) {
  resize(indices.size());
  for (std::size_t k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(indices[k]);
    put(k, surface[i], surface.sigma[i]);
  }
}

void SurfaceBatch::fill(const SurfacePoints& surface) {
  resize(surface.size());
  for (std::size_t k = 0; k < count; ++k) put(k, surface[k], surface.sigma[k]);
}

}  // namespace phasescan
