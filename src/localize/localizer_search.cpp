// When and how a Localizer searches the whole map.
#include <algorithm>
#include <cmath>
#include <utility>

#include "localize/localizer_impl.hpp"

namespace phasescan {
namespace {

constexpr double kClearlyBetter = 10.0;  // of log-likelihood, for a pose elsewhere to be taken instead
constexpr double kVerifyEveryM = 5.0;    // a pose that is ok is compared with the whole map
constexpr std::size_t kLastViews = 4;    // that a pose which odometry contradicts must explain

}  // namespace

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
    // The pose that is followed, found a little beside itself, is not a place of which little is usual.
    if (state.set.led(state.set.all.front().at.T_grid_base, T_odom_base) != Led::kThere)
      state.set.usual_explained = explained_share(T_odom_base);
    state.poor_scans = 0;
  } else {
    state.set.merge(found, T_odom_base, kKeepGap, most());
  }
}

}  // namespace phasescan
