#include "phasescan/localize/localizer.hpp"

#include <Eigen/LU>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "localize/likelihood.hpp"
#include "localize/localizer_impl.hpp"
#include "localize/pose_confidence.hpp"
#include "odometry/information.hpp"

namespace phasescan {
namespace {

// A scan from so far away, or turned so far, is another view: what it says is new.
constexpr double kNewViewM = 0.25, kNewViewRad = 0.35;
constexpr double kViewShare = 0.5;  // of a view's log-likelihood that counts: views overlap
constexpr double kMemory = 0.985;   // of the usual share explained, a scan: about 12 s of a slow sensor
// Odometry is off by this a step beside a share of it [m], [rad].
constexpr double kStepM = 0.01, kStepRad = 0.005, kStepShare = 0.1;
constexpr double kKnownM = 30.0;    // of way, that odometry alone tells where the robot is not
constexpr double kNarrowRad = 5.0;  // a scan narrower than this is another view once it is turned

double field_of_view(const Scan& scan) {
  const std::size_t n = scan.size();
  return n > 1 ? static_cast<double>(n) * std::abs(scan.angle(1) - scan.angle(0)) : 0.0;
}

}  // namespace

/// Every hypothesis moves with odometry and is matched near where that leads.
void Localizer::Impl::track(const QueryScan& query, const OdometryUpdate& odometry_update, bool new_view) {
  const Pose2 step = state.T_odom_last.inverse() * odometry_update.T_odom_base;
  const double off_m = kStepM + kStepShare * std::hypot(step.x, step.y),
               off_rad = kStepRad + kStepShare * std::abs(step.theta);
  for (Hypothesis& h : state.set.all) {
    PosePrior prior;
    prior.T_map_base = h.T_grid_odom * odometry_update.T_odom_base;
    Eigen::Matrix3d covariance = h.at.covariance;
    covariance.diagonal() += Eigen::Vector3d(off_m * off_m, off_m * off_m, off_rad * off_rad);
    prior.information = covariance.inverse() / kMatchTrust;
    FoundPose found = match_near(map.data(), query, prior.T_map_base, prior);
    if (!found.T_grid_base.is_finite() || found.fit.explained < 0.5 * kLeastExplained) {
      found.T_grid_base = prior.T_map_base;
      found.fit = fit_to_map(map.data().grid, query.beams, found.T_grid_base);
      found.covariance = covariance;
    }
    h.at = found;
    h.T_grid_odom = found.T_grid_base * odometry_update.T_odom_base.inverse();
    if (new_view) h.weight += kViewShare * state.set.log_likelihood(found, odometry_update.T_odom_base);
  }
  if (new_view) state.set.see(odometry_update.T_odom_base, options.ambiguous_gap);
  state.set.prune(kKeepGap, most());
}

LocalizationUpdate Localizer::Impl::add(const RangeMeasurement& measurement) {
  check_measurement(measurement);
  LocalizationUpdate update;
  update.stamp = measurement.scan.stamp;
  update.scan = state.scans++;
  const OdometryUpdate odom = odometry.add(measurement);
  update.twist = odom.twist;
  update.T_odom_base = odom.T_odom_base;
  const QueryScan query = prepare_query(measurement, odometry_options.deskew ? odom.twist : Twist2{},
                                        options.view_range_m, true, query_work);
  if (!query.usable()) {
    judge(false, measurement, update);
    if (update.status == TrackingStatus::kOk) update.status = TrackingStatus::kDegraded;
    return update;
  }
  const Pose2 step = state.T_odom_last.inverse() * odom.T_odom_base,
              view = state.T_odom_view.inverse() * odom.T_odom_base;
  state.way_since_search += std::hypot(step.x, step.y);
  ++state.scans_since_search;
  if (state.set.known) state.set.known->way_m += std::hypot(step.x, step.y);
  if (broke(odom)) state.set.forget_way(), state.past.clear();
  if (state.set.known && state.set.known->way_m > kKnownM) state.set.known.reset();
  const bool narrow = field_of_view(measurement.scan) < kNarrowRad;
  const bool new_view = std::hypot(view.x, view.y) > kNewViewM || (narrow && std::abs(view.theta) > kNewViewRad);
  if (state.given) {
    take_given(query, odom.T_odom_base);
  } else if (!state.set.empty()) {
    track(query, odom, new_view);
  } else {
    state.scans_since_search = state.scans_since_search == 1 && update.scan == 0 ? 0 : state.scans_since_search;
  }
  notice_carrying(odom.T_odom_base);
  bool poor = fits_poorly(odom);
  if (poor && state.poor_scans++ == 0) state.poor_since = update.stamp;
  if (!poor) state.poor_scans = 0;
  const TrackingStatus before = state.set.empty() ? TrackingStatus::kLost : judge_best(odom.T_odom_base).status;
  if (wants_search(poor, before)) {
    search(query, odom.T_odom_base, poor);
    update.searched = true;
    poor = poor && state.poor_scans > 0;
  }
  if (!poor && !state.set.empty()) {
    state.set.usual_explained =
        kMemory * state.set.usual_explained + (1.0 - kMemory) * explained_share(odom.T_odom_base);
  }
  state.last_explained = state.set.empty() ? 0.0 : explained_share(odom.T_odom_base);
  if (new_view || state.past.size() == 0) {
    state.past.add(query.beams, odom.T_odom_base, std::hypot(view.x, view.y));
    state.T_odom_view = odom.T_odom_base;
  }
  state.T_odom_last = odom.T_odom_base;
  judge(poor, measurement, update);
  return update;
}

Localizer::Localizer(LocalizationMap map, const LocalizeOptions& options, const OdometryOptions& odometry) {
  validate_options("localize", options);
  impl_ = std::make_unique<Impl>(Impl{std::move(map), options, odometry, Odometry(odometry), {}, {}, {}});
}
Localizer::~Localizer() = default;
Localizer::Localizer(Localizer&&) noexcept = default;
Localizer& Localizer::operator=(Localizer&&) noexcept = default;

void Localizer::initialize(const Pose2& T_map_base, const Eigen::Matrix3d& covariance) {
  if (!T_map_base.is_finite() || !covariance.allFinite())
    throw std::invalid_argument("T_map_base: pose or covariance not finite");
  impl_->state.given = PoseEstimate{T_map_base, covariance, 0.0};
}

void Localizer::initialize_globally() {
  impl_->state.set = {};
  impl_->state.given.reset();
  impl_->state.scans_since_search = kSearchEveryScans;
}

LocalizationUpdate Localizer::add(const RangeMeasurement& measurement) {
  return impl_->add(measurement);
}

const LocalizationMap& Localizer::map() const {
  return impl_->map;
}

}  // namespace phasescan
