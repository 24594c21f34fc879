#include "slam/keyframe_points.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace phasescan {
namespace {

constexpr float kMostSteps = 32767.0F;
constexpr std::uint16_t kLone = 0xFFFF;  // code of a point without a normal
constexpr float kQuadrant = 16383.0F;    // steps of a quarter of a turn; four of them stay below kLone

std::uint16_t pack_coordinate(float value, float step) {
  const float steps = step > 0.0F ? std::clamp(std::round(value / step), -kMostSteps, kMostSteps) : 0.0F;
  return static_cast<std::uint16_t>(static_cast<std::int16_t>(steps));
}

float unpack_coordinate(std::uint16_t code, float step) {
  return step * static_cast<float>(static_cast<std::int16_t>(code));
}

/// The quadrant of a direction, and how far into it by the ratio of the two sides: no trigonometry to read it.
std::uint16_t pack_direction(float nx, float ny) {
  const float sum = std::fabs(nx) + std::fabs(ny);
  if (!(sum > 0.0F)) return kLone;
  int quadrant = 0;
  float into = 0.0F;
  if (nx > 0.0F && ny >= 0.0F) {
    quadrant = 0, into = ny / sum;
  } else if (ny > 0.0F) {
    quadrant = 1, into = -nx / sum;
  } else if (nx < 0.0F) {
    quadrant = 2, into = -ny / sum;
  } else {
    quadrant = 3, into = nx / sum;
  }
  const int steps = static_cast<int>(std::lround(into * kQuadrant)) + quadrant * static_cast<int>(kQuadrant);
  return static_cast<std::uint16_t>(steps % (4 * static_cast<int>(kQuadrant)));
}

void unpack_direction(std::uint16_t code, float& nx, float& ny) {
  if (code == kLone) {
    nx = ny = 0.0F;
    return;
  }
  const int quadrant = code / static_cast<int>(kQuadrant);
  const float into = static_cast<float>(code - quadrant * static_cast<int>(kQuadrant)) / kQuadrant;
  const float scale = 1.0F / std::sqrt(into * into + (1.0F - into) * (1.0F - into));
  const float along = (1.0F - into) * scale, across = into * scale;
  switch (quadrant) {
    case 0:
      nx = along, ny = across;
      return;
    case 1:
      nx = -across, ny = along;
      return;
    case 2:
      nx = -along, ny = -across;
      return;
    default:
      nx = across, ny = -along;
      return;
  }
}

/// The upper half of a float without its last `spare` bits, rounded to nearest. Variances are not negative; infinity
/// stays what it is.
std::uint16_t pack_variance(float value, int spare = 0) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return static_cast<std::uint16_t>(std::min(bits + (0x8000U << spare), 0x7F800000U) >> (16 + spare) << spare);
}

float unpack_variance(std::uint16_t code) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(code) << 16);
}

}  // namespace

KeyframePoints::KeyframePoints(const MapPoints& points) {
  float farthest = 0.0F;
  for (std::size_t i = 0; i < points.size(); ++i)
    farthest = std::max({farthest, std::fabs(points.x[i]), std::fabs(points.y[i])});
  step_m_ = farthest / kMostSteps;
  codes_.reserve(5 * points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    codes_.push_back(pack_coordinate(points.x[i], step_m_));
    codes_.push_back(pack_coordinate(points.y[i], step_m_));
    codes_.push_back(pack_direction(points.nx[i], points.ny[i]));
    codes_.push_back(pack_variance(points.variance[i]));
    // The spare bit says whether the point stands free.
    const std::uint16_t normal = pack_variance(points.normal_variance[i], 1);
    codes_.push_back(static_cast<std::uint16_t>(normal | (points.free_standing[i] ? 1U : 0U)));
  }
}

void KeyframePoints::unpack(MapPoints& out) const {
  out.clear();
  const std::size_t n = size();
  for (auto* v : {&out.x, &out.y, &out.nx, &out.ny, &out.variance, &out.normal_variance}) v->resize(n);
  out.free_standing.resize(n);
  const std::uint16_t* code = codes_.data();
  for (std::size_t i = 0; i < n; ++i, code += 5) {
    out.x[i] = unpack_coordinate(code[0], step_m_);
    out.y[i] = unpack_coordinate(code[1], step_m_);
    unpack_direction(code[2], out.nx[i], out.ny[i]);
    out.variance[i] = unpack_variance(code[3]);
    out.normal_variance[i] = unpack_variance(code[4] & 0xFFFEU);
    out.free_standing[i] = code[4] & 1U;
    out.with_normal += code[2] != kLone;
  }
}

}  // namespace phasescan
