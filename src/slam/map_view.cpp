#include "slam/map_view.hpp"

#include <utility>

namespace phasescan {
namespace {

class MapView final : public MapSnapshot {
 public:
  MapView(std::shared_ptr<const BackendSnapshot> snapshot, const SlamOptions& options)
      : snapshot_(std::move(snapshot)), options_(options) {}

  std::uint64_t version() const override { return snapshot_->version; }
  const Pose2& T_map_odom() const override { return snapshot_->T_map_odom; }

  std::vector<MapKeyframe> keyframes() const override {
    std::vector<MapKeyframe> keyframes;
    keyframes.reserve(snapshot_->poses.size());
    for (std::size_t i = 0; i < snapshot_->poses.size(); ++i)
      keyframes.push_back({snapshot_->poses[i], snapshot_->nodes[i].id, snapshot_->pieces.of_node[i]});
    return keyframes;
  }

  const std::shared_ptr<const BackendSnapshot>& snapshot() const { return snapshot_; }

  TrinaryMap draw() const override {
    return SnapshotRenderer(options_.map, options_.odometry.deskew, options_.slam.largest_piece).map(*snapshot_);
  }

 private:
  std::shared_ptr<const BackendSnapshot> snapshot_;
  SlamOptions options_;
};

}  // namespace

std::shared_ptr<const BackendSnapshot> behind(const MapSnapshot& view) {
  const auto* own = dynamic_cast<const MapView*>(&view);
  return own == nullptr ? nullptr : own->snapshot();
}

std::shared_ptr<const MapSnapshot> make_map_view(std::shared_ptr<const BackendSnapshot> snapshot,
                                                 const SlamOptions& options) {
  return std::make_shared<MapView>(std::move(snapshot), options);
}

}  // namespace phasescan
