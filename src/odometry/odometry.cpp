#include "phasescan/odometry/odometry.hpp"

#include "odometry/checked_tracker.hpp"

namespace phasescan {

const char* to_string(TrackingStatus status) {
  switch (status) {
    case TrackingStatus::kInitialising:
      return "initialising";
    case TrackingStatus::kOk:
      return "ok";
    case TrackingStatus::kDegraded:
      return "degraded";
    case TrackingStatus::kAmbiguous:
      return "ambiguous";
    case TrackingStatus::kLost:
      return "lost";
  }
  return "";
}

struct Odometry::Impl {
  CheckedTracker tracker;
};

Odometry::Odometry(const OdometryOptions& options) : impl_(std::make_unique<Impl>(Impl{CheckedTracker(options)})) {}
Odometry::~Odometry() = default;
Odometry::Odometry(Odometry&&) noexcept = default;
Odometry& Odometry::operator=(Odometry&&) noexcept = default;

OdometryUpdate Odometry::add(const RangeMeasurement& measurement) {
  const TrackerStep step = impl_->tracker.add(measurement).step;
  return {step.stamp, step.status, step.T_odom_stamp, step.covariance, step.twist, step.keyframe, step.diagnostics};
}

WheelCounts Odometry::wheels() const {
  return impl_->tracker.state().motion.wheels.counts;
}

}  // namespace phasescan
