#include "live/line_damage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace phasescan::live {
namespace {

// A single scan that lacks much is matched well by what was before; a row of them is not.
constexpr double kWeight = 0.25;
constexpr double kHeavy = 0.5, kLight = 0.35;
constexpr double kMostConfidence = 0.5;

}  // namespace

double lost_share(const Scan& scan, std::optional<Stamp> before) {
  constexpr double kMissing = 2.5;  // turns
  const auto count = static_cast<double>(std::max<std::size_t>(1, scan.size()));
  const auto invalid = static_cast<double>(std::count(scan.states.begin(), scan.states.end(), BeamState::kInvalid));
  const double here = 1.0 - invalid / count, step = std::abs(scan.geometry.angle_increment);
  const double turn_s = step > 0.0 ? kTwoPi / step * scan.time_increment : 0.0;
  if (!before || turn_s <= 0.0) return 1.0 - here;
  const double turns = stamp_to_seconds(scan.stamp - *before) / turn_s;
  return turns < kMissing ? 1.0 - here : 1.0 - here / turns;
}

void LineDamage::add(double lost) {
  lost_ += kWeight * (lost - lost_);
  heavy_ = lost_ > (heavy_ ? kLight : kHeavy);
}

void LineDamage::judge(LiveUpdate& live) {
  if (heavy_ != told_) {
    told_ = heavy_;
    live.warnings.push_back(heavy_ ? fmt::format("damaged line: {:.0f} % of the beams are lost; no pose is called ok "
                                                 "(cable, USB adapter, baud?)",
                                                 100.0 * lost_)
                                   : std::string("the line is better: most beams arrive"));
  }
  if (!heavy_) return;
  live.confidence = std::min(live.confidence, kMostConfidence);
  if (live.update.status == TrackingStatus::kOk) live.update.status = TrackingStatus::kDegraded;
  if (!live.located) return;
  live.located->confidence = std::min(live.located->confidence, kMostConfidence);
  live.located->status = live.update.status;
}

}  // namespace phasescan::live
