#include "output/convert_targets.hpp"

#include <algorithm>
#include <array>

#include "io/file.hpp"
#include "io/log_writers.hpp"
#include "io/pose_writer.hpp"
#include "map/occupancy_grid.hpp"
#include "output/g2o.hpp"
#include "output/map_file.hpp"
#include "phasescan/map/trinary_map.hpp"

namespace phasescan {
namespace {

class G2oWriter final : public PoseWriter {
 public:
  using PoseWriter::PoseWriter;

 protected:
  void add_pose(const LogEntry&, const Pose2& T_odom_base) override {
    MapKeyframe pose;
    pose.T_map_base = T_odom_base;
    poses_.push_back(pose);
    const auto last = static_cast<std::int32_t>(poses_.size()) - 1;
    if (last == 0) return;
    // Wheels say nothing of how sure they are: 5 cm and 2 degrees a step.
    constexpr double kPosition = 1.0 / (0.05 * 0.05);
    const double heading = 1.0 / (deg_to_rad(2.0) * deg_to_rad(2.0));
    MapEdge edge;
    edge.from = last - 1;
    edge.to = last;
    edge.T_from_to = poses_[poses_.size() - 2].T_map_base.inverse() * T_odom_base;
    edge.information = Eigen::Vector3d(kPosition, kPosition, heading).asDiagonal();
    steps_.push_back(edge);
  }
  void write() override { write_file(path(), format_g2o(poses_, steps_)); }

 private:
  std::vector<MapKeyframe> poses_;
  std::vector<MapEdge> steps_;
};

/// NAME.pgm and NAME.yaml, whichever of the two was named.
class MapWriter final : public PoseWriter {
 public:
  explicit MapWriter(const std::string& path) : PoseWriter(path), stem_(path.substr(0, path.find_last_of('.'))) {}

 protected:
  void add_pose(const LogEntry& entry, const Pose2& T_odom_base) override {
    grid_.add_scan(entry.flipped ? mirrored_scan(entry.scan) : entry.scan, T_odom_base * entry.T_base_laser);
  }
  void write() override {
    const TrinaryMap map = make_trinary(grid_);
    // Both or none: an image beside the yaml of another map would be read with its scale.
    AtomicFile image(stem_ + ".pgm"), yaml(stem_ + ".yaml");
    image.write(format_pgm(map));
    yaml.write(format_map_yaml(map, stem_.substr(stem_.find_last_of('/') + 1) + ".pgm"));
    image.seal();
    yaml.seal();
    image.commit();
    yaml.commit();
  }

 private:
  std::string stem_;
  OccupancyGrid grid_;
};

struct Ending {
  std::string_view ending;
  std::string_view target;
};
constexpr Ending kEndings[] = {{".g2o", "g2o"}, {".pgm", "map"}, {".yaml", "map"}};

}  // namespace

std::vector<std::string> convert_target_names() {
  std::vector<std::string> names = log_target_names();
  names.insert(names.end(), {"g2o", "map"});
  return names;
}

std::string convert_target_for(const std::string& path) {
  for (const Ending& ending : kEndings) {
    if (path.ends_with(ending.ending)) return std::string(ending.target);
  }
  if (const auto target = find_log_target(path)) return log_target_names()[static_cast<std::size_t>(*target)];
  std::string known = log_endings();
  for (const Ending& ending : kEndings) known += ", " + std::string(ending.ending);
  throw InputError(path, 0, "the name does not tell the format; expected one ending in " + known + ", or --format");
}

std::unique_ptr<LogWriter> make_convert_writer(const std::string& target, const std::string& path) {
  if (target == "g2o") return std::make_unique<G2oWriter>(path);
  if (target == "map") return std::make_unique<MapWriter>(path);
  const auto& names = log_target_names();
  const auto found = std::find(names.begin(), names.end(), target);
  if (found == names.end()) throw std::invalid_argument("target: '" + target + "' is not one of convert's");
  return make_log_writer(static_cast<LogTarget>(found - names.begin()), path);
}

}  // namespace phasescan
