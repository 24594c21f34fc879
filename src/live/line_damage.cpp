#include "live/line_damage.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace phasescan::live {
namespace {

// A single scan that lacks much is matched well by what was before; a row of them is not.
constexpr double kWeight = 0.25;
constexpr double kHeavy = 0.5, kLight = 0.35;
constexpr double kMostConfidence = 0.5;

}  // namespace

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
