#include "io/beam_geometry.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "phasescan/core/pose2.hpp"

namespace phasescan {
namespace {

bool is_turn(double field_of_view) {
  return std::abs(field_of_view - kTwoPi) < 1e-6;
}

}  // namespace

bool is_stated(const BeamGeometry& beams) {
  return beams.field_of_view || beams.angle_min || beams.angle_increment;
}

BeamFan fan_of(const BeamGeometry& beams, std::size_t count) {
  const auto n = static_cast<double>(count);
  const double steps = count > 1 ? n - 1.0 : 1.0;
  const double sign = beams.clockwise ? -1.0 : 1.0;
  double step = kTwoPi / n;
  bool turn = true;
  if (beams.field_of_view) {
    turn = is_turn(*beams.field_of_view);
    step = turn ? kTwoPi / n : *beams.field_of_view / steps;
    if (beams.angle_increment && std::abs(*beams.angle_increment - step) > 0.5 * step / steps) {
      throw std::invalid_argument(fmt::format(
          "--fov {:g} and --angle-increment {:g} contradict each other for {} beams; expected an increment of {:.6g}",
          rad_to_deg(*beams.field_of_view), rad_to_deg(*beams.angle_increment), count, rad_to_deg(step)));
    }
  } else if (beams.angle_increment) {
    step = *beams.angle_increment;
    turn = std::abs(step * n - kTwoPi) < 0.5 * step;
  }
  const double first = turn ? 0.0 : -step * steps / 2.0;
  return {beams.angle_min.value_or(sign * first), sign * step};
}

std::string assumed_of(const BeamGeometry& beams) {
  std::string out;
  if (!beams.field_of_view && !beams.angle_increment) out = "a full turn";
  if (!beams.angle_min && out.empty()) return "";
  if (!beams.angle_min) out += " from 0";
  return out + (beams.clockwise ? ", clockwise" : ", counter-clockwise");
}

}  // namespace phasescan
