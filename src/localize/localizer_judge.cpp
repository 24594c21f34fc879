// What a Localizer says of the pose that it follows.
#include <algorithm>
#include <cmath>

#include "localize/localizer_impl.hpp"
#include "localize/pose_confidence.hpp"

namespace phasescan {
namespace {

constexpr double kPoorShare = 0.6;  // of the usual share of hits explained: less is a poor fit
constexpr double kLostAfterS = 1.0;
constexpr int kLostAfterScans = 10;
constexpr double kFollowedM = 10.0;  // a pose that was ok and was followed since is not lost for so long
// Share explained that is lost from one scan to the next where a robot is carried away. On simulated drives through
// changed and half mapped flats about one scan in 4,000 lost as much without it.
constexpr double kCarriedDrop = 0.4;

}  // namespace

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

/// The pose is where odometry leads from one that was ok not long ago. In a room whose furniture was moved, and
/// in one that the map lacks, the map explains next to nothing.
bool Localizer::Impl::is_followed(const Pose2& T_odom_base) const {
  const FoundPose& best = state.set.all.front().at;
  return state.set.known && state.set.known->way_m < kFollowedM &&
         state.set.led(best.T_grid_base, T_odom_base) == Led::kThere;
}

/// The map explains no less of the last scan than a place that the map has not would by chance, or than was usual.
bool Localizer::Impl::explains_enough(const Pose2& T_odom_base) const {
  const FoundPose& best = state.set.all.front().at;
  return evidence_of_view(best.fit, state.set.led(best.T_grid_base, T_odom_base), state.set.usual_explained) > 0.0;
}

Judged Localizer::Impl::judge_best(const Pose2& T_odom_base) const {
  const FoundPose& best = state.set.all.front().at;
  return judge_followed(best, state.set.led(best.T_grid_base, T_odom_base), state.set.margin(), options);
}

void Localizer::Impl::judge(bool poor, const RangeMeasurement& measurement, LocalizationUpdate& update) {
  if (state.set.empty()) {
    update.status = state.located ? TrackingStatus::kLost : TrackingStatus::kInitialising;
    return;
  }
  const Judged judged = judge_best(update.T_odom_base);
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
  // Never ok: it may be a place that the map has not, on a wrong map too.
  if (update.status == TrackingStatus::kDegraded && !state.located) update.status = TrackingStatus::kAmbiguous;
  report_hypotheses(map.data(), state.set, measurement.T_base_laser, options, update);
}

}  // namespace phasescan
