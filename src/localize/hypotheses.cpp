#include "localize/hypotheses.hpp"

#include <algorithm>

#include "localize/pose_confidence.hpp"

namespace phasescan {
namespace {

constexpr double kCarriedAway = 6.0;  // of log-likelihood: a robot is seldom where nothing led to

}  // namespace

double HypothesisSet::margin() const {
  if (all.empty()) return 0.0;
  return all.size() == 1 ? margin_alone : std::min(all[0].weight - all[1].weight, kMostMargin);
}

void HypothesisSet::restart(const std::vector<FoundPose>& found, const Pose2& T_odom_base, double keep_gap,
                            std::size_t most) {
  all.clear();
  for (const FoundPose& pose : found)
    all.push_back({pose.T_grid_base * T_odom_base.inverse(), pose, pose.fit.log_likelihood});
  margin_alone = found.size() > 1 ? found[0].fit.log_likelihood - found[1].fit.log_likelihood : kMostMargin;
  prune(keep_gap, most);
}

void HypothesisSet::merge(const std::vector<FoundPose>& found, const Pose2& T_odom_base, double keep_gap,
                          std::size_t most) {
  if (all.empty()) return restart(found, T_odom_base, keep_gap, most);
  const double weight = all.front().weight, likelihood = all.front().at.fit.log_likelihood;
  for (const FoundPose& pose : found) {
    const bool known = std::any_of(all.begin(), all.end(),
                                   [&](const Hypothesis& h) { return !is_apart(h.at.T_grid_base, pose.T_grid_base); });
    if (known) continue;
    all.push_back(
        {pose.T_grid_base * T_odom_base.inverse(), pose, weight + pose.fit.log_likelihood - likelihood - kCarriedAway});
  }
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
