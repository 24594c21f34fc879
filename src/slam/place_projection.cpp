#include "slam/place_projection.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace phasescan {
namespace {

#include "slam/place_projection.inc"

PlaceProjection unpack() {
  PlaceProjection out;
  for (std::size_t f = 0; f < kPlaceFeatures; ++f) {
    out.mean[f] = kMean[f];
    for (std::size_t d = 0; d < kDescriptorSize; ++d)
      out.weights[f][d] = kStep[d] / kSpread[f] * static_cast<float>(place_number(kWeights[d][f]));
  }
  return out;
}

}  // namespace

void PlaceProjection::apply(const PlaceFeatures& features, PlaceDescriptor& out) const {
  std::array<float, kDescriptorSize> sums{};
  for (std::size_t f = 0; f < kPlaceFeatures; ++f) {
    const float value = features[f] - mean[f];
    for (std::size_t d = 0; d < kDescriptorSize; ++d) sums[d] += value * weights[f][d];
  }
  for (std::size_t d = 0; d < kDescriptorSize; ++d)
    out[d] = static_cast<std::int8_t>(std::clamp(std::round(sums[d]), -127.0F, 127.0F));
}

const PlaceProjection& place_projection() {
  static const PlaceProjection projection = unpack();
  return projection;
}

}  // namespace phasescan
