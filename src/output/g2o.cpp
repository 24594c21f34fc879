#include "output/g2o.hpp"

#include "io/number.hpp"

namespace phasescan {

std::string format_g2o(const PoseGraph& graph) {
  std::string text;
  const auto put = [&](auto... values) { ((text += ' ', append_number(text, values)), ...); };
  for (std::size_t i = 0; i < graph.poses().size(); ++i) {
    const Pose2& p = graph.poses()[i];
    text += "VERTEX_SE2";
    put(i, p.x, p.y, p.theta);
    text += '\n';
  }
  if (!graph.poses().empty()) text += "FIX 0\n";
  for (const PoseEdge& e : graph.edges()) {
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
