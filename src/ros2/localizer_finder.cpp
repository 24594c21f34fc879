#include "ros2/localizer_finder.hpp"

#include "phasescan/localize/localizer.hpp"

namespace phasescan::ros2 {
namespace {

class LocalizerFinder final : public PoseFinder {
 public:
  explicit LocalizerFinder(Localizer localizer) : localizer_(std::move(localizer)) {}

  void initialize(const Pose2& T_map_base, const Eigen::Matrix3d& covariance) override {
    localizer_.initialize(T_map_base, covariance);
  }
  void initialize_globally() override { localizer_.initialize_globally(); }
  FoundPose add(const RangeMeasurement& measurement) override {
    const LocalizationUpdate update = localizer_.add(measurement);
    FoundPose out{update.status, update.T_map_base, update.covariance, update.confidence, {}};
    for (const PoseEstimate& estimate : update.hypotheses)
      out.hypotheses.push_back({estimate.T_map_base, estimate.confidence});
    return out;
  }

 private:
  Localizer localizer_;
};

}  // namespace

std::unique_ptr<PoseFinder> LocalizerFinders::make(const TrinaryMap& map) {
  return std::make_unique<LocalizerFinder>(Localizer(LocalizationMap::from_grid(map, localize_), localize_, odometry_));
}

}  // namespace phasescan::ros2
