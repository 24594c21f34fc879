#include "phasescan/live/turns.hpp"

#include <algorithm>
#include <cmath>

#include "live/angle_shift.hpp"
#include "phasescan/core/pose2.hpp"

namespace phasescan::live {
namespace {

// No sensor here has more than 6,400 beams a turn (S2 at 5 Hz); a turn beyond this never ends.
constexpr std::size_t kMostBeams = 20000;
// Two beams this many steps apart have others between them that are lost. Corrected directions are not looked at.
constexpr double kGapSteps = 1.75;
// The start of a turn may be told a little late, as by YDLIDAR's packet that begins it; later than this it is lost.
constexpr double kMostOverTurn = deg_to_rad(10.0);
constexpr double kLeastTurn = kPi;
// Of a turn: so far the time that has passed and the angle may be apart. Packets come late by less.
constexpr double kMostApart = 0.35;
// Directions are rounded: a beam may lie so far before the last one and still follow it.
constexpr double kMostBack = deg_to_rad(2.0);
// Farther on it is a jump and not the next beam.
constexpr double kMostOn = 0.5 * kPi;
// So many torn turns in a row: the head turns at another speed now.
constexpr int kTornTurns = 3;
// Directions that are even to this have no need to be told one by one.
constexpr double kEven_rad = 1e-6;

}  // namespace

void TurnAssembler::restart() {
  if (open_ && !beams_.empty()) ++counts_.partial;
  open_ = false;
  beams_.clear();
  swept_ = 0.0;
  closed_.reset();
}

void TurnAssembler::add(std::span<const Beam> beams, double range_min, double range_max, std::vector<Scan>& out) {
  range_min_ = range_min;
  range_max_ = range_max;
  for (const Beam& beam : beams) add_one(beam, out);
}

void TurnAssembler::add_one(const Beam& beam, std::vector<Scan>& out) {
  if (beam.mark == TurnMark::kRestarts) restart();
  if (open_ && !beams_.empty() && !goes_on(beam)) {
    ++counts_.torn;
    restart();
    closed_ = beam;
  }
  if (open_ && !beams_.empty()) fill_lost(beam, out);
  // Not every sensor says where a turn starts in each packet: after a torn turn the next one starts at the head's zero.
  const bool passes_zero = closed_ && closed_->sweep + turned_on(closed_->sweep, beam.sweep) >= kTwoPi &&
                           turned_on(closed_->sweep, beam.sweep) < kMostOn;
  if (closed_) closed_ = beam;
  if (beam.mark == TurnMark::kStarts || passes_zero) {
    if (open_ && !beams_.empty()) finish(out);
    open_ = true;
    closed_.reset();
  } else if (open_ && swept_ > kTwoPi + kMostOverTurn) {
    finish(out);
  }
  if (!open_) return;
  if (beams_.size() >= kMostBeams) return restart();
  beams_.push_back(beam);
  if (beam.ends_turn) {
    finish(out);
    open_ = false;
  }
}

/// How far the head has turned on since the last beam; NaN: the sensor does not say.
double TurnAssembler::turned_since(const Beam& beam) const {
  const double on = turned_on(beams_.back().sweep, beam.sweep);
  return on > kTwoPi - kMostBack ? 0.0 : on;
}

/// Whether the head can have turned from the last beam to this one in the time between them. Where bytes were missing
/// for longer than a turn, or a wrong packet passed its check, direction and time say different things.
bool TurnAssembler::goes_on(const Beam& beam) {
  const double on = turned_since(beam);
  if (std::isnan(on) || turn_s_ <= 0.0) return true;
  const double turns = stamp_to_seconds(beam.stamp - beams_.back().stamp) / turn_s_;
  if (std::abs(turns - on / kTwoPi) < kMostApart) return true;
  if (++torn_in_a_row_ >= kTornTurns) turn_s_ = 0.0;
  return false;
}

/// Beams of lost packets, up to `beam`; those past the head's zero belong to the turn that `beam` starts.
void TurnAssembler::fill_lost(const Beam& beam, std::vector<Scan>& out) {
  const Beam before = beams_.back();
  const double on = turned_since(beam);
  if (std::isnan(on) || on <= 0.0) return;
  const double sense = wrap_angle(beam.angle - before.angle) < 0.0 ? -1.0 : 1.0;
  if (step_ <= 0.0 || on <= kGapSteps * step_) {
    step_ += (step_ <= 0.0 ? 1.0 : 0.05) * (on - step_);
    swept_ += on;
    return;
  }
  const auto steps = static_cast<std::size_t>(std::min(std::round(on / step_), static_cast<double>(kMostBeams)));
  bool new_turn = beam.mark != TurnMark::kStarts;
  for (std::size_t i = 1; i < steps; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(steps);
    Beam lost;
    lost.sweep = std::fmod(before.sweep + share * on, kTwoPi);
    lost.angle = before.angle + sense * share * on;
    lost.state = BeamState::kInvalid;
    lost.stamp = before.stamp + static_cast<Stamp>(share * static_cast<double>(beam.stamp - before.stamp));
    if (!new_turn && before.sweep + share * on >= kTwoPi) {
      swept_ += share * on;
      finish(out);
      new_turn = true;
    }
    if (beams_.size() < kMostBeams) beams_.push_back(lost);
    ++counts_.lost_beams;
  }
  swept_ += on;
}

void TurnAssembler::finish(std::vector<Scan>& out) {
  const bool whole = std::isnan(beams_.front().sweep) || beams_.back().ends_turn || swept_ >= kLeastTurn;
  if (whole && beams_.size() >= 2) {
    out.push_back(scan_of_turn());
    ++counts_.turns;
    torn_in_a_row_ = 0;
    if (swept_ >= kLeastTurn) turn_s_ = kTwoPi / swept_ * stamp_to_seconds(beams_.back().stamp - beams_.front().stamp);
  } else {
    ++counts_.partial;
  }
  beams_.clear();
  swept_ = 0.0;
}

Scan TurnAssembler::scan_of_turn() const {
  const std::size_t n = beams_.size();
  // Each direction within half a turn of the one before, so that they go on through the turn.
  std::vector<double> angles;
  for (const Beam& beam : beams_) {
    const double base = angles.empty() ? 0.0 : angles.back();
    angles.push_back(base + wrap_angle(beam.angle - base));
  }
  const double sense = angles.back() < angles.front() ? -1.0 : 1.0;
  std::vector<std::size_t> order(n);
  for (std::size_t i = 0; i < n; ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return sense * angles[a] < sense * angles[b]; });
  std::vector<float> raw, directions, intensities;
  bool any_intensity = false;
  Stamp first = beams_.front().stamp, last = first;
  for (const std::size_t i : order) {
    const Beam& beam = beams_[i];
    const float none = beam.state == BeamState::kInvalid ? std::numeric_limits<float>::quiet_NaN() : 0.0F;
    raw.push_back(beam.state == BeamState::kInvalid || beam.state == BeamState::kNoReturn ? none : beam.range_m);
    directions.push_back(static_cast<float>(angles[i]));
    intensities.push_back(beam.intensity);
    any_intensity |= beam.intensity != 0.0F;
    first = std::min(first, beam.stamp);
    last = std::max(last, beam.stamp);
  }
  const double from = angles[order.front()], steps = static_cast<double>(n - 1);
  double increment = (angles[order.back()] - from) / steps;
  bool even = increment != 0.0;
  for (std::size_t i = 0; i < n && even; ++i)
    even = std::abs(angles[order[i]] - from - static_cast<double>(i) * increment) < kEven_rad;
  if (increment == 0.0) increment = sense * kTwoPi / static_cast<double>(n);
  Scan scan = make_scan(raw, {from, increment, range_min_, range_max_}, even ? std::vector<float>() : directions);
  scan.stamp = first;
  scan.time_increment = stamp_to_seconds(last - first) / steps;
  if (any_intensity) scan.intensities = std::move(intensities);
  return scan;
}

}  // namespace phasescan::live
