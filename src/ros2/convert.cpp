#include "ros2/convert.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace phasescan::ros2 {
namespace {

constexpr int kOccupied = 65, kFree = 19;
constexpr std::uint64_t kMostCells = 1ULL << 28;
using ros::kPlanar;  // where x, y and the turn stand among six

}  // namespace

Pose to_pose(const Pose2& pose) {
  return {{pose.x, pose.y, 0.0}, {0.0, 0.0, std::sin(pose.theta / 2.0), std::cos(pose.theta / 2.0)}};
}

Pose2 to_pose2(const Pose& pose) {
  const Quaternion& q = pose.orientation;
  const double n = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
  if (!std::isfinite(n) || !std::isfinite(pose.position.x) || !std::isfinite(pose.position.y))
    throw std::invalid_argument("pose: its numbers are not finite");
  const double theta =
      n > 0.0 ? std::atan2(2.0 * (q.x * q.y + q.w * q.z), q.w * q.w + q.x * q.x - q.y * q.y - q.z * q.z) : 0.0;
  return {pose.position.x, pose.position.y, theta};
}

TransformStamped to_transform(Stamp stamp, const std::string& parent, const std::string& child, const Pose2& pose) {
  const Pose full = to_pose(pose);
  return {{stamp, parent}, child, {{full.position.x, full.position.y, 0.0}, full.orientation}};
}

Covariance6 to_covariance6(const Eigen::Matrix3d& covariance) {
  Covariance6 out{};
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) out[static_cast<std::size_t>(6 * kPlanar[i] + kPlanar[k])] = covariance(i, k);
  }
  return out;
}

Eigen::Matrix3d to_covariance3(const Covariance6& covariance) {
  Eigen::Matrix3d out;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) out(i, k) = covariance[static_cast<std::size_t>(6 * kPlanar[i] + kPlanar[k])];
  }
  const bool usable = out.allFinite() && out.diagonal().minCoeff() >= 0.0 && out.diagonal().maxCoeff() > 0.0;
  if (usable) return out;
  const double turn = deg_to_rad(15.0);
  return Eigen::Vector3d(0.25, 0.25, turn * turn).asDiagonal();
}

PoseWithCovarianceStamped to_pose_message(Stamp stamp, const std::string& frame, const Pose2& pose,
                                          const Eigen::Matrix3d& covariance) {
  return {{stamp, frame}, {to_pose(pose), to_covariance6(covariance)}};
}

OccupancyGrid to_grid(const TrinaryMap& map, Stamp stamp, const std::string& frame) {
  OccupancyGrid grid;
  grid.header = {stamp, frame};
  grid.info = {stamp, static_cast<float>(map.resolution_m), static_cast<std::uint32_t>(map.width),
               static_cast<std::uint32_t>(map.height), to_pose(map.origin)};
  grid.data.reserve(map.cells.size());
  for (const CellState cell : map.cells) grid.data.push_back(static_cast<std::int8_t>(cell));
  return grid;
}

TrinaryMap to_map(const OccupancyGrid& grid) {
  const std::uint64_t cells = std::uint64_t{grid.info.width} * grid.info.height;
  if (cells == 0 || cells > kMostCells) throw std::invalid_argument("map.width: no grid has that many cells");
  if (grid.data.size() != cells)
    throw std::invalid_argument("map.data: " + std::to_string(grid.data.size()) +
                                " cells, expected width * height = " + std::to_string(cells));
  if (!(grid.info.resolution > 0.0F && grid.info.resolution <= 10.0F))
    throw std::invalid_argument("map.resolution: expected metres per cell above 0, up to 10");
  TrinaryMap map;
  map.width = static_cast<int>(grid.info.width);
  map.height = static_cast<int>(grid.info.height);
  // 0.05 comes as the nearest float: the double that a yaml says is the one with its six digits.
  map.resolution_m = std::round(double{grid.info.resolution} * 1e7) / 1e7;
  map.origin = to_pose2(grid.info.origin);
  map.cells.reserve(grid.data.size());
  for (const std::int8_t cell : grid.data) {
    map.cells.push_back(cell >= kOccupied            ? CellState::kOccupied
                        : cell >= 0 && cell <= kFree ? CellState::kFree
                                                     : CellState::kUnknown);
  }
  return map;
}

}  // namespace phasescan::ros2
