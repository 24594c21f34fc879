#include "output/g2o.hpp"

#include "io/number.hpp"

namespace phasescan {

std::string format_g2o(std::span<const MapKeyframe> keyframes, std::span<const MapEdge> edges) {
  std::string text;
  const auto put = [&](auto... values) { ((text += ' ', append_number(text, values)), ...); };
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    const Pose2& p = keyframes[i].T_map_base;
    text += "VERTEX_SE2";
    put(i, p.x, p.y, p.theta);
    text += '\n';
  }
  if (!keyframes.empty()) text += "FIX 0\n";
  for (const MapEdge& e : edges) {
    if (!e.enabled) continue;
    const Eigen::Matrix3d& I = e.information;
    text += "EDGE_SE2";
    put(e.from, e.to, e.T_from_to.x, e.T_from_to.y, e.T_from_to.theta, I(0, 0), I(0, 1), I(0, 2), I(1, 1), I(1, 2),
        I(2, 2));
    text += '\n';
  }
  return text;
}

}  // namespace phasescan
