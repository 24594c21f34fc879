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
  float squares = 0.0F;
  for (const float sum : sums) squares += sum * sum;
  const float scale = squares > 0.0F ? kDescriptorLength / std::sqrt(squares) : 0.0F;
  for (std::size_t d = 0; d < kDescriptorSize; ++d)
    out[d] = static_cast<std::int8_t>(std::clamp(std::round(scale * sums[d]), -127.0F, 127.0F));
}

const PlaceProjection& place_projection() {
  static const PlaceProjection projection = unpack();
  return projection;
}

}  // namespace phasescan
