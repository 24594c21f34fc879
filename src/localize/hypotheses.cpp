#include "localize/hypotheses.hpp"

#include <algorithm>

#include "localize/pose_confidence.hpp"

namespace phasescan {
namespace {

constexpr double kCarriedAway = 6.0;  // of log-likelihood: a robot is seldom where nothing led to
// A place in a room that the map has not explains half of most scans, and 0.7 of those of a room that looks like one of
// the map's. Where odometry contradicts a pose, that is what it is: robots drive more often than they are carried. What
// odometry leads to is right although much of what is seen is new; what lies where the map knows nothing says nothing.
constexpr double kNeutralThere = 0.45, kNeutralExplained = 0.58, kNeutralElsewhere = 0.75, kPerShare = 40.0;
// Where the map explained nearly all, half of a scan is little: it is the next room, which only looked the same.
constexpr double kOfUsual = 0.65;
constexpr double kMostOfView = 8.0, kMostAlone = 4.0;
constexpr double kMostOfNew = 6.0;     // of a view for a pose not followed before: rooms look alike for about a metre
constexpr double kLeastAhead = -16.0;  // of none: about two metres of good views make up for it
constexpr double kUnknownLog = 2.3;   // of a hit, less than that of one that nothing explains: one in two instead of 20
constexpr double kDriftShare = 0.05;  // of the way, that odometry may be off by

}  // namespace

double evidence_of_view(const MapFit& fit, Led led, double usual) {
  const bool there = led == Led::kThere;
  const double neutral = there                    ? std::max(kNeutralThere, kOfUsual * usual)
                         : led == Led::kElsewhere ? kNeutralElsewhere
                                                  : kNeutralExplained;
  return std::clamp(kPerShare * (fit.explained - 0.5 * fit.contradicting - neutral * (1.0 - fit.unknown)), -kMostOfView,
                    there ? kMostOfView : kMostOfNew);
}

double log_likelihood_where_led(const MapFit& fit) {
  return fit.log_likelihood + kUnknownLog * fit.unknown * static_cast<double>(fit.hits);
}

double explained_of_known(const MapFit& fit) {
  return fit.unknown < 1.0 ? fit.explained / (1.0 - fit.unknown) : 0.0;
}

void HypothesisSet::forget_way() {
  known.reset();
  looks = 0;
}

double HypothesisSet::found_ahead(const FoundPose& pose, Led led) const {
  const double found = led == Led::kThere       ? kFoundWhereLed
                       : led == Led::kElsewhere ? kFoundElsewhere
                       : looks < kFirstLooks    ? kFoundFirst
                                                : kFoundAgain;
  // Where odometry leads, the views before have been counted.
  const double past = led == Led::kThere ? std::min(0.0, pose.of_past) : pose.of_past;
  return std::clamp(found + past, kLeastAhead, kMostMargin);
}

double HypothesisSet::log_likelihood(const FoundPose& pose, const Pose2& T_odom_base) const {
  return led(pose.T_grid_base, T_odom_base) == Led::kThere ? log_likelihood_where_led(pose.fit)
                                                           : pose.fit.log_likelihood;
}

Led HypothesisSet::led(const Pose2& T_grid_base, const Pose2& T_odom_base) const {
  if (!known) return Led::kUnknown;
  const Pose2 led = known->T_grid_odom * T_odom_base;
  const bool there = translation_distance(led, T_grid_base) < kApartM + kDriftShare * known->way_m &&
                     angle_distance(led.theta, T_grid_base.theta) < 2.0 * kApartRad;
  return there ? Led::kThere : Led::kElsewhere;
}

void HypothesisSet::see(const Pose2& T_odom_base, double least_margin) {
  for (Hypothesis& h : all) {
    ++h.views;
    const double evidence = evidence_of_view(h.at.fit, led(h.at.T_grid_base, T_odom_base), usual_explained);
    h.ahead_of_none = std::clamp(h.ahead_of_none + evidence, kLeastAhead, kMostMargin);
  }
  if (all.size() != 1) return;
  const double more = std::clamp(evidence_of_view(all.front().at.fit, Led::kUnknown), 0.0, kMostAlone);
  margin_alone = std::clamp(margin_alone + more, least_margin, kMostMargin);
}

double HypothesisSet::margin() const {
  if (all.empty()) return 0.0;
  const double to_next = all.size() == 1 ? margin_alone : std::min(all[0].weight - all[1].weight, kMostMargin);
  return std::max(0.0, std::min(to_next, all.front().ahead_of_none));
}

void HypothesisSet::restart(const std::vector<FoundPose>& found, const Pose2& T_odom_base, double keep_gap,
                            std::size_t most) {
  const std::vector<Hypothesis> followed = std::move(all);
  all.clear();
  for (const FoundPose& pose : found) {
    double ahead = found_ahead(pose, led(pose.T_grid_base, T_odom_base));
    int views = 0;
    for (const Hypothesis& h : followed) {
      if (is_apart(h.T_grid_odom * T_odom_base, pose.T_grid_base)) continue;
      ahead = std::max(ahead, h.ahead_of_none);
      views = std::max(views, h.views);
    }
    all.push_back({pose.T_grid_base * T_odom_base.inverse(), pose, log_likelihood(pose, T_odom_base), ahead, views});
  }
  ++looks;
  margin_alone = kMostMargin;
  prune(keep_gap, most);
}

void HypothesisSet::find_again(const FoundPose& pose, const Pose2& T_odom_base, Hypothesis& known_one) const {
  const Led how = led(pose.T_grid_base, T_odom_base);
  if (!(evidence_of_view(pose.fit, how, usual_explained) > 0.0)) return;
  const bool followed = how != Led::kElsewhere && known_one.views >= kFollowedViews;
  const double least = followed ? kFoundWhereFollowed : kLeastAhead;
  known_one.ahead_of_none = std::max({known_one.ahead_of_none, found_ahead(pose, how), least});
}

void HypothesisSet::merge(const std::vector<FoundPose>& found, const Pose2& T_odom_base, double keep_gap,
                          std::size_t most) {
  if (all.empty()) return restart(found, T_odom_base, keep_gap, most);
  const double weight = all.front().weight, likelihood = log_likelihood(all.front().at, T_odom_base);
  for (const FoundPose& pose : found) {
    const auto same = std::find_if(all.begin(), all.end(),
                                   [&](const Hypothesis& h) { return !is_apart(h.at.T_grid_base, pose.T_grid_base); });
    if (same != all.end()) {
      if (&pose == &found.front()) find_again(pose, T_odom_base, *same);
      continue;
    }
    all.push_back({pose.T_grid_base * T_odom_base.inverse(), pose,
                   weight + log_likelihood(pose, T_odom_base) - likelihood - kCarriedAway,
                   found_ahead(pose, led(pose.T_grid_base, T_odom_base))});
  }
  ++looks;
  prune(keep_gap, most);
}

void HypothesisSet::prune(double keep_gap, std::size_t most) {
  std::stable_sort(all.begin(), all.end(),
                   [](const Hypothesis& a, const Hypothesis& b) { return a.weight > b.weight; });
  std::vector<Hypothesis> kept;
  const std::size_t before = all.size();
  double next_behind = kMostMargin;
  bool apart = false;
  for (const Hypothesis& h : all) {
    const bool joined = std::any_of(kept.begin(), kept.end(),
                                    [&](const Hypothesis& k) { return !is_apart(k.at.T_grid_base, h.at.T_grid_base); });
    if (joined) continue;
    const double behind = kept.empty() ? 0.0 : kept.front().weight - h.weight;
    if (!kept.empty()) next_behind = std::min(next_behind, behind), apart = true;
    if (kept.size() >= most || behind > keep_gap) continue;
    kept.push_back(h);
  }
  // Where all others came to the same pose, that they were within the gap is what is known.
  if (kept.size() == 1 && before > 1) margin_alone = apart ? next_behind : std::min(margin_alone, keep_gap);
  all = std::move(kept);
}

}  // namespace phasescan
