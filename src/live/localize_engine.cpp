// A known map behind the door of `live`: each scan is located there, and nothing changes the map.
#include <utility>

#include "phasescan/live/live.hpp"

namespace phasescan::live {
namespace {

class KnownMap final : public MapSnapshot {
 public:
  explicit KnownMap(TrinaryMap map) : map_(std::move(map)) {}
  std::uint64_t version() const override { return 1; }
  const Pose2& T_map_odom() const override { return T_map_odom_; }
  std::vector<MapKeyframe> keyframes() const override { return {}; }
  TrinaryMap draw() const override { return map_; }

 private:
  const TrinaryMap map_;
  const Pose2 T_map_odom_;
};

class LocalizeEngine final : public LiveEngine {
 public:
  LocalizeEngine(std::function<Localizer()> begin, TrinaryMap drawn)
      : begin_(std::move(begin)), localizer_(begin_()), map_(std::make_shared<const KnownMap>(std::move(drawn))) {}

  LiveUpdate add(std::shared_ptr<const RangeMeasurement> measurement) override {
    LiveUpdate out;
    LocalizationUpdate& at = out.located.emplace(localizer_.add(*measurement));
    stay_lost(at);
    out.measurement = std::move(measurement);
    out.map = map_;
    out.confidence = at.confidence;
    out.on_map = at.T_map_base.has_value();
    if (at.T_map_base) T_map_odom_ = *at.T_map_base * at.T_odom_base.inverse();
    ScanUpdate& update = out.update;
    update.stamp = at.stamp;
    update.scan = at.scan;
    update.status = at.status;
    update.T_odom_base = at.T_odom_base;
    update.T_map_odom = T_map_odom_;
    update.map_version = map_->version();
    update.twist = at.twist;
    const bool somewhere = at.T_map_base && at.status != TrackingStatus::kLost;
    update.map_covariance = somewhere ? at.covariance : Eigen::Matrix3d(kNowhere * Eigen::Matrix3d::Identity());
    return out;
  }

  std::string set_pose(const Pose2& T_map_base) override {
    // As good as a click into a map on a screen.
    constexpr double kM = 0.3, kRad = 0.15;
    lost_ = false;
    localizer_.initialize(T_map_base, Eigen::Vector3d(kM * kM, kM * kM, kRad * kRad).asDiagonal());
    return "it looks near there with the next scan";
  }

  std::string relocalise() override {
    localizer_.initialize_globally();
    return "it looks for itself on the whole map";
  }

  void restart() override {
    localizer_ = begin_();
    lost_ = false;
    T_map_odom_ = {};
  }

 private:
  /// Who was lost is found again where he is sure: a first guess elsewhere is no pose to go by.
  void stay_lost(LocalizationUpdate& at) {
    if (at.status == TrackingStatus::kLost) lost_ = true;
    if (at.status == TrackingStatus::kOk) lost_ = false;
    if (lost_ && at.status == TrackingStatus::kDegraded) at.status = TrackingStatus::kLost;
  }

  static constexpr double kNowhere = 1e6;  // [m^2, rad^2]: as the covariance of what cannot be known is capped
  std::function<Localizer()> begin_;
  Localizer localizer_;
  std::shared_ptr<const KnownMap> map_;
  bool lost_ = false;
  Pose2 T_map_odom_;  // as of the last pose
};

}  // namespace

std::unique_ptr<LiveEngine> localize_engine(std::function<Localizer()> begin, TrinaryMap drawn) {
  return std::make_unique<LocalizeEngine>(std::move(begin), std::move(drawn));
}

}  // namespace phasescan::live
