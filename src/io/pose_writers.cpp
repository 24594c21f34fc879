// What can be made of a log's poses: a trajectory, a graph of its steps, a map drawn from them.
#include "io/log_writers.hpp"
#include "graph/pose_graph.hpp"
#include "phasescan/io/error.hpp"
#include "io/file.hpp"
#include "io/g2o.hpp"
#include "io/map_file.hpp"
#include "io/tum.hpp"
#include "map/occupancy_grid.hpp"
#include "phasescan/map/trinary_map.hpp"

namespace phasescan {
namespace {

/// Takes the pose of each entry: odometry, or where there is none the log's own estimate.
class PoseWriter : public LogWriter {
 public:
  explicit PoseWriter(std::string path) : path_(std::move(path)) {}
  void add(const LogEntry& entry) final {
    const std::optional<Pose2>& pose = entry.odometry ? entry.odometry : entry.corrected;
    if (!pose) {
      add_loss("scans without a pose are left out");
      return;
    }
    ++poses_;
    add_pose(entry, *pose);
  }
  void finish() final {
    if (poses_ == 0) {
      throw InputError(path_, 0, "the log has no poses; expected odometry (from scans alone: `phasescan slam`)");
    }
    write();
  }

 protected:
  virtual void add_pose(const LogEntry& entry, const Pose2& T_odom_base) = 0;
  virtual void write() = 0;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  std::size_t poses_ = 0;
};

class TumWriter final : public PoseWriter {
 public:
  using PoseWriter::PoseWriter;

 protected:
  void add_pose(const LogEntry& entry, const Pose2& T_odom_base) override {
    poses_.push_back({entry.scan.stamp, T_odom_base});
  }
  void write() override { write_file(path(), format_tum(poses_)); }

 private:
  std::vector<StampedPose> poses_;
};

class G2oWriter final : public PoseWriter {
 public:
  using PoseWriter::PoseWriter;

 protected:
  void add_pose(const LogEntry&, const Pose2& T_odom_base) override {
    const int node = graph_.add_node(T_odom_base);
    if (node == 0) return;
    // Wheels say nothing of how sure they are: 5 cm and 2 degrees a step.
    constexpr double kPosition = 1.0 / (0.05 * 0.05);
    const double heading = 1.0 / (deg_to_rad(2.0) * deg_to_rad(2.0));
    const Pose2& before = graph_.poses()[static_cast<std::size_t>(node - 1)];
    PoseEdge edge;
    edge.from = node - 1;
    edge.to = node;
    edge.T_from_to = before.inverse() * T_odom_base;
    edge.information = Eigen::Vector3d(kPosition, kPosition, heading).asDiagonal();
    graph_.add_edge(edge);
  }
  void write() override { write_file(path(), format_g2o(graph_)); }

 private:
  PoseGraph graph_;
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

}  // namespace

std::unique_ptr<LogWriter> make_tum_writer(const std::string& path) {
  return std::make_unique<TumWriter>(path);
}
std::unique_ptr<LogWriter> make_g2o_writer(const std::string& path) {
  return std::make_unique<G2oWriter>(path);
}
std::unique_ptr<LogWriter> make_map_writer(const std::string& path) {
  return std::make_unique<MapWriter>(path);
}

}  // namespace phasescan
