#include "match/hypothesis_list.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace phasescan {
namespace {

constexpr double kDistinct = 0.02, kDistinctLeast_m = 0.05, kDistinctTurn_deg = 4.0;  // share of the scale
constexpr double kTwinTurn_rad = 0.25 * kPi;

bool precedes(const Pose2& a, const Pose2& b) {
  return std::tie(a.theta, a.x, a.y) < std::tie(b.theta, b.x, b.y);
}

}  // namespace

bool same_pose(const Pose2& a, const Pose2& b, double metres, double radians) {
  // Most poses are far apart along one axis: no need for the exact distance.
  if (std::abs(a.x - b.x) >= metres || std::abs(a.y - b.y) >= metres) return false;
  return translation_distance(a, b) < metres && angle_distance(a.theta, b.theta) < radians;
}

bool same_answer(const Pose2& a, const Pose2& b, double scale_m) {
  return same_pose(a, b, std::max(kDistinct * scale_m, kDistinctLeast_m), deg_to_rad(kDistinctTurn_deg));
}

bool better(const Hypothesis& a, const Hypothesis& b) {
  return a.score > b.score || (a.score == b.score && precedes(a.T_ref_scan, b.T_ref_scan));
}
bool coarsely_better(const Hypothesis& a, const Hypothesis& b) {
  return a.coarse > b.coarse || (a.coarse == b.coarse && precedes(a.T_ref_scan, b.T_ref_scan));
}

void sort_distinct(std::vector<Hypothesis>& all, double scale_m, std::vector<Hypothesis>& distinct) {
  std::sort(all.begin(), all.end(), better);
  distinct.clear();
  for (const Hypothesis& h : all) {
    const bool known = std::any_of(distinct.begin(), distinct.end(), [&](const Hypothesis& k) {
      return same_answer(h.T_ref_scan, k.T_ref_scan, scale_m);
    });
    if (!known) distinct.push_back(h);
  }
}

void keep_finalists(std::size_t most, std::vector<Hypothesis>& sorted) {
  if (sorted.size() <= most) return;
  const double theta = sorted.front().T_ref_scan.theta;
  const auto turned = [&](const Hypothesis& h) { return angle_distance(h.T_ref_scan.theta, theta) > kTwinTurn_rad; };
  const auto last = sorted.begin() + static_cast<std::ptrdiff_t>(most);
  if (most > 1 && std::none_of(sorted.begin(), last, turned)) {
    const auto other = std::find_if(last, sorted.end(), turned);
    if (other != sorted.end()) *(last - 1) = *other;
  }
  sorted.erase(last, sorted.end());
}

bool prefer_less_turn(double margin, std::vector<Hypothesis>& sorted) {
  auto least = sorted.begin();
  for (auto h = sorted.begin() + 1; h != sorted.end(); ++h) {
    if (h->score > sorted.front().score - margin &&
        std::abs(h->T_ref_scan.theta) < std::abs(least->T_ref_scan.theta) - kTwinTurn_rad)
      least = h;
  }
  std::rotate(sorted.begin(), least, least + 1);
  return least != sorted.begin();
}

}  // namespace phasescan
