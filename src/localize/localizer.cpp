#include "phasescan/localize/localizer.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "localize/likelihood.hpp"
#include "localize/locate.hpp"
#include "localize/map_data.hpp"
#include "localize/past_views.hpp"
#include "localize/pose_confidence.hpp"
#include "odometry/information.hpp"

namespace phasescan {
namespace {

// A scan from so far away, or turned so far, is another view: what it says is new.
constexpr double kNewViewM = 0.25, kNewViewRad = 0.35;
constexpr double kViewShare = 0.5;  // of a view's log-likelihood that counts: views overlap
constexpr double kKeepGap = 18.0;   // hypotheses this far behind are dropped
constexpr double kPoorShare = 0.6;  // of the usual share of hits explained: less is a poor fit
constexpr double kLeastExplained = 0.35;
constexpr double kMemory = 0.97;
constexpr double kClearlyBetter = 10.0;  // of log-likelihood, for a pose elsewhere to be taken instead
constexpr double kLostAfterS = 1.0;
constexpr int kLostAfterScans = 10;
// Odometry is off by this a step beside a share of it [m], [rad].
constexpr double kStepM = 0.01, kStepRad = 0.005, kStepShare = 0.1;
constexpr int kSearchEveryScans = 5;  // while lost

constexpr std::size_t kLastViews = 4;  // that a pose which odometry contradicts must explain

constexpr double kFollowedM = 10.0;    // a pose that was ok and was followed since is not lost for so long
constexpr double kKnownM = 30.0;       // of way, that odometry alone tells where the robot is not
constexpr double kVerifyEveryM = 5.0;  // a pose that is ok is compared with the whole map
constexpr double kNarrowRad = 5.0;     // a scan narrower than this is another view once it is turned

double field_of_view(const Scan& scan) {
  const std::size_t n = scan.size();
  return n > 1 ? static_cast<double>(n) * std::abs(scan.angle(1) - scan.angle(0)) : 0.0;
}

/// Share explained that is lost from one scan to the next only where a robot is carried away: of 24,000 scans of
/// simulated drives through changed and half mapped flats, seven lost so much without it.
constexpr double kCarriedDrop = 0.4;

/// Odometry does not say how the robot came here.
bool broke(const OdometryUpdate& odometry) {
  return odometry.status == TrackingStatus::kLost || odometry.diagnostics.new_segment;
}

struct State {
  HypothesisSet set;
  PastViews past;
  std::optional<PoseEstimate> given;  ///< by initialize, for the next scan
  Pose2 T_odom_last, T_odom_view;
  double way_since_search = 0.0;
  double last_explained = 0.0;  ///< by what is followed
  Stamp poor_since = 0;
  int poor_scans = 0;
  int scans_since_search = 0;
  bool located = false;
  ScanId scans = 0;
};

}  // namespace

struct Localizer::Impl {
  LocalizationMap map;
  LocalizeOptions options;
  OdometryOptions odometry_options;
  Odometry odometry;
  State state;
  QueryWorkspace query_work;
  GlobalSearchWorkspace search_work;

  LocalizationUpdate add(const RangeMeasurement& measurement);
  void take_given(const QueryScan& query, const Pose2& T_odom_base);
  void track(const QueryScan& query, const OdometryUpdate& odometry_update, bool new_view);
  void notice_carrying(const Pose2& T_odom_base);
  double explained_share(const Pose2& T_odom_base) const;
  bool explains_past(FoundPose& pose, const Pose2& T_odom_base) const;
  std::vector<FoundPose> find(const QueryScan& query, const Pose2& T_odom_base);
  bool fits_poorly(const OdometryUpdate& odometry_update) const;
  bool wants_search(bool poor, TrackingStatus status) const;
  void search(const QueryScan& query, const Pose2& T_odom_base, bool poor);
  bool explains_enough(const Pose2& T_odom_base) const;
  bool is_followed(const Pose2& T_odom_base) const;
  void judge(bool poor, const RangeMeasurement& measurement, LocalizationUpdate& update);
  std::size_t most() const { return static_cast<std::size_t>(options.max_hypotheses); }
};

/// The pose that was given, and places around it as far as it is unsure.
void Localizer::Impl::take_given(const QueryScan& query, const Pose2& T_odom_base) {
  const Pose2 T_grid_given = map.data().T_map_grid.inverse() * state.given->T_map_base;
  const Eigen::Matrix3d& covariance = state.given->covariance;
  const double spread_m = std::min(2.0, 2.0 * std::sqrt(std::max(covariance(0, 0), covariance(1, 1))));
  const double spread_rad = std::min(1.0, 2.0 * std::sqrt(covariance(2, 2)));
  const int shifts = static_cast<int>(std::ceil(spread_m / 0.3)),
            turns = static_cast<int>(std::ceil(spread_rad / 0.15));
  std::vector<FoundPose> found;
  for (int a = -turns; a <= turns; ++a) {
    for (int i = -shifts; i <= shifts; ++i) {
      for (int k = -shifts; k <= shifts; ++k)
        found.push_back(match_near(
            map.data(), query,
            {T_grid_given.x + 0.3 * i, T_grid_given.y + 0.3 * k, wrap_angle(T_grid_given.theta + 0.15 * a)}));
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const FoundPose& a, const FoundPose& b) { return a.fit.log_likelihood > b.fit.log_likelihood; });
  found.resize(1);
  state.set.restart(found, T_odom_base, kKeepGap, most());
  state.set.all.front().ahead_of_none = kFoundWhereLed;
  state.given.reset();
}

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

/// Odometry may match a place to which the robot was carried; the map then suddenly explains little.
void Localizer::Impl::notice_carrying(const Pose2& T_odom_base) {
  if (state.set.empty()) return;
  const double explained = explained_share(T_odom_base);
  if (explained < state.last_explained - kCarriedDrop) state.set.forget_way(), state.past.clear();
}

/// Of the hits of the last scan; where odometry leads to the pose, of those where the map knows something.
double Localizer::Impl::explained_share(const Pose2& T_odom_base) const {
  const FoundPose& best = state.set.all.front().at;
  return state.set.led(best.T_grid_base, T_odom_base) == Led::kThere ? explained_of_known(best.fit)
                                                                     : best.fit.explained;
}

bool Localizer::Impl::fits_poorly(const OdometryUpdate& odometry_update) const {
  if (state.set.empty()) return true;
  if (!(state.set.all.front().ahead_of_none > 0.0)) return true;  // as likely a place that the map has not
  const double explained = explained_share(odometry_update.T_odom_base);
  return explained < kLeastExplained || explained < kPoorShare * state.set.usual_explained || broke(odometry_update);
}

bool Localizer::Impl::wants_search(bool poor, TrackingStatus status) const {
  if (state.set.empty()) return state.scans_since_search == 0 || state.scans_since_search >= kSearchEveryScans;
  if (poor) return state.poor_scans <= 2 || state.scans_since_search >= kSearchEveryScans;
  return state.way_since_search > (status == TrackingStatus::kOk ? kVerifyEveryM : options.search_every_m);
}

/// Says what the views before say for a pose. @return false where odometry contradicts it and the last views do too
bool Localizer::Impl::explains_past(FoundPose& pose, const Pose2& T_odom_base) const {
  const Led how = state.set.led(pose.T_grid_base, T_odom_base);
  const Pose2 T_grid_odom = pose.T_grid_base * T_odom_base.inverse();
  pose.of_past = state.past.evidence(map.data().grid, T_grid_odom, how);
  if (how != Led::kElsewhere) return true;
  return evidence_of_view(pose.fit, how) + state.past.evidence(map.data().grid, T_grid_odom, how, kLastViews) > 0.0;
}

/// What a search finds and where odometry leads from the last pose that was ok, likeliest first.
std::vector<FoundPose> Localizer::Impl::find(const QueryScan& query, const Pose2& T_odom_base) {
  std::vector<FoundPose> found = search_thoroughly(map.data(), query, options, search_work);
  if (state.set.known) {
    const FoundPose led = match_near(map.data(), query, state.set.known->T_grid_odom * T_odom_base);
    const bool there = state.set.led(led.T_grid_base, T_odom_base) == Led::kThere;
    const bool new_one = std::all_of(
        found.begin(), found.end(), [&](const FoundPose& pose) { return is_apart(pose.T_grid_base, led.T_grid_base); });
    if (there && new_one) found.push_back(led);
  }
  std::stable_sort(found.begin(), found.end(), [&](const FoundPose& a, const FoundPose& b) {
    return state.set.log_likelihood(a, T_odom_base) > state.set.log_likelihood(b, T_odom_base);
  });
  while (found.size() > most()) found.pop_back();
  std::erase_if(found, [&](FoundPose& pose) { return !explains_past(pose, T_odom_base); });
  return found;
}

void Localizer::Impl::search(const QueryScan& query, const Pose2& T_odom_base, bool poor) {
  const std::vector<FoundPose> found = find(query, T_odom_base);
  state.way_since_search = 0.0;
  state.scans_since_search = 0;
  if (found.empty()) return;
  const auto likely = [&](const FoundPose& pose) { return state.set.log_likelihood(pose, T_odom_base); };
  const bool better = state.set.empty() || likely(found.front()) > likely(state.set.all.front().at) + kClearlyBetter;
  if (state.set.empty() || (poor && better)) {
    state.set.restart(found, T_odom_base, kKeepGap, most());
    state.set.usual_explained = explained_share(T_odom_base);
    state.poor_scans = 0;
  } else {
    state.set.merge(found, T_odom_base, kKeepGap, most());
  }
}

/// The pose is where odometry leads from one that was ok not long ago, and the map explains some of what is seen.
bool Localizer::Impl::is_followed(const Pose2& T_odom_base) const {
  const FoundPose& best = state.set.all.front().at;
  return state.set.known && state.set.known->way_m < kFollowedM &&
         state.set.led(best.T_grid_base, T_odom_base) == Led::kThere && explained_of_known(best.fit) > kLeastExplained;
}

/// The map explains no less of the last scan than a place that the map has not would by chance, or than was usual.
bool Localizer::Impl::explains_enough(const Pose2& T_odom_base) const {
  const FoundPose& best = state.set.all.front().at;
  return evidence_of_view(best.fit, state.set.led(best.T_grid_base, T_odom_base), state.set.usual_explained) > 0.0;
}

void Localizer::Impl::judge(bool poor, const RangeMeasurement& measurement, LocalizationUpdate& update) {
  if (state.set.empty()) {
    update.status = state.located ? TrackingStatus::kLost : TrackingStatus::kInitialising;
    return;
  }
  const Judged judged = judge_pose(state.set.all.front().at, state.set.margin(), options);
  update.status = judged.status;
  update.confidence = judged.confidence;
  if (poor && state.poor_scans > 0) {
    const bool long_poor =
        state.poor_scans > kLostAfterScans || stamp_to_seconds(measurement.scan.stamp - state.poor_since) > kLostAfterS;
    update.status = long_poor && !is_followed(update.T_odom_base) ? TrackingStatus::kLost : TrackingStatus::kDegraded;
    update.confidence = std::min(update.confidence, 0.5);
  }
  if (update.status == TrackingStatus::kLost && !poor && is_followed(update.T_odom_base))
    update.status = TrackingStatus::kDegraded;
  if (update.status == TrackingStatus::kOk && !explains_enough(update.T_odom_base))
    update.status = TrackingStatus::kDegraded;
  if (update.status == TrackingStatus::kOk) {
    state.set.known = KnownPlace{state.set.all.front().T_grid_odom, 0.0};
  }
  state.located |= update.status == TrackingStatus::kOk;
  report_hypotheses(map.data(), state.set, measurement.T_base_laser, options, update);
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
  const TrackingStatus before = state.set.empty()
                                    ? TrackingStatus::kLost
                                    : judge_pose(state.set.all.front().at, state.set.margin(), options).status;
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
