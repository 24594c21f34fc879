#include "localize/past_views.hpp"

#include <algorithm>

#include "localize/likelihood.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kStride = 2;  // of the judged hits
constexpr double kOffPerM = 0.02;   // standard deviation of odometry over 1 m of way [m]

}  // namespace

void PastViews::add(const JudgedBeams& beams, const Pose2& T_odom_base, double way_m) {
  if (views_.size() == kMostViews) views_.pop_front();
  const auto more = static_cast<float>(kOffPerM * kOffPerM * way_m);
  for (View& view : views_) {
    for (float& variance : view.beams.variance) variance += more;
  }
  views_.push_back({beams, T_odom_base});
}

double PastViews::evidence(const MapGrid& grid, const Pose2& T_grid_odom, Led led, std::size_t most_views) const {
  double sum = 0.0;
  for (std::size_t i = views_.size() - std::min(views_.size(), most_views); i < views_.size(); ++i) {
    const Pose2 T_grid_base = T_grid_odom * views_[i].T_odom_base;
    sum += evidence_of_view(fit_to_map(grid, views_[i].beams, T_grid_base, true, kStride), led);
  }
  return sum;
}

}  // namespace phasescan
