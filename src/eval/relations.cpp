#include "eval/relations.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

#include "phasescan/io/error.hpp"
#include "io/file.hpp"

namespace phasescan {

std::vector<Relation> read_relations(const std::string& path) {
  LineReader lines(path);
  std::vector<Relation> relations;
  std::string line;
  while (lines.next(line)) {
    const long number = lines.line_number();
    const auto first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') continue;
    std::istringstream fields(line);
    double v[8];
    for (double& value : v) {
      if (!(fields >> value) || !std::isfinite(value)) {
        throw InputError(path, number, "expected 8 numbers: time_a time_b x y z roll pitch yaw");
      }
    }
    relations.push_back({stamp_from_seconds(v[0]), stamp_from_seconds(v[1]), {v[2], v[3], wrap_angle(v[7])}});
  }
  return relations;
}

RelationErrors relation_errors(std::span<const StampedPose> trajectory, std::span<const Relation> relations,
                               const Pose2& T_base_laser, double max_gap_s) {
  RelationErrors out;
  out.relations = relations.size();
  std::vector<std::size_t> order(trajectory.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return trajectory[a].stamp < trajectory[b].stamp; });
  const auto max_gap = static_cast<Stamp>(max_gap_s * 1e9);
  const auto find = [&](Stamp stamp) -> const StampedPose* {
    const auto after = std::lower_bound(order.begin(), order.end(), stamp,
                                        [&](std::size_t i, Stamp s) { return trajectory[i].stamp < s; });
    const StampedPose* best = nullptr;
    for (auto it = after == order.begin() ? after : after - 1; it != order.end() && it <= after; ++it) {
      const StampedPose& pose = trajectory[*it];
      if (std::abs(pose.stamp - stamp) > max_gap) continue;
      if (!best || std::abs(pose.stamp - stamp) < std::abs(best->stamp - stamp)) best = &pose;
    }
    return best;
  };
  double worst = -1.0;
  for (const Relation& relation : relations) {
    const StampedPose* a = find(relation.stamp_a);
    const StampedPose* b = find(relation.stamp_b);
    if (!a || !b) {
      ++out.unanswered;
      continue;
    }
    const Pose2 estimate = (a->pose * T_base_laser).inverse() * (b->pose * T_base_laser);
    const Pose2 error = relation.T_a_b.inverse() * estimate;
    out.translation.push_back(std::hypot(error.x, error.y));
    out.rotation.push_back(std::abs(error.theta));
    if (out.translation.back() > worst) {
      worst = out.translation.back();
      out.worst_translation_stamp_a = stamp_to_seconds(relation.stamp_a);
    }
  }
  return out;
}

}  // namespace phasescan
