#include "odometry/own_body.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "phasescan/core/pose2.hpp"

namespace phasescan {
namespace {

constexpr float kFarthestM = 2.5F;                   // [m] parts of a robot are nearer
constexpr float kSameM = 0.03F, kSameShare = 0.02F;  // [m], of the range: three standard deviations of cheap sensors
constexpr float kSameSigmas = 4.2F;                  // where a sensor is noisier: three of the difference of two ranges
constexpr float kChangedM = 0.1F;                    // [m] beyond that the range changed
constexpr double kChangedShare = 0.15;               // of the directions: the robot moved, or much moved around it
constexpr double kLeastMoveM = 0.15, kLeastMoveRad = 0.12;  // [m], [rad] of a pair that tells something
constexpr int kWaitScans = 3;                               // until a pair that moved less is tried again
constexpr int kDifferedOnce = -1;                           // `wait` when the scan before differed from the reference
constexpr double kThroughM = 0.12;  // [m] a scan looked through a place if it saw so much farther
// Pairs until it is decided, and where something is suspect; and matches tried for them.
constexpr std::size_t kPairs = 12, kMostPairs = 40, kMostTries = 80;
// A direction belongs to the body if its range was the same in this share of the pairs, and contradicts the scene in so
// many of them; most directions of a run need the first alone. One bad scan spoils two of a dozen pairs.
constexpr double kSameShareOfPairs = 0.8;
constexpr std::uint16_t kContradicted = 3;
constexpr int kLeastBins = 3;  // in a row
constexpr int kEdgeBins = 1;   // beside it: beams that meet its edge
constexpr int kGapBins = 3;    // that hardly any pair saw, within a run

using Bins = std::array<float, kBodyBins>;
constexpr float kNone = std::numeric_limits<float>::infinity();

std::size_t bin_of(double angle) {
  // Directions of whole degrees lie in the middle of a bin, where rounding does not move them to the next.
  const auto bin = static_cast<std::size_t>(wrap_positive(angle) / kTwoPi * kBodyBins + 0.5);
  return bin % kBodyBins;
}

/// The nearest hit in each direction.
void fill_bins(const Scan& scan, Bins& bins) {
  bins.fill(kNone);
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (!scan.is_hit(i)) continue;
    float& bin = bins[bin_of(scan.angle(i))];
    bin = std::min(bin, scan.ranges[i]);
  }
}

/// Standard deviation of the ranges [m], from how far hits lie beside the line between their neighbours.
float noise_of(const Scan& scan) {
  std::vector<float> bends;
  for (std::size_t i = 1; i + 1 < scan.size(); ++i) {
    if (scan.is_hit(i - 1) && scan.is_hit(i) && scan.is_hit(i + 1))
      bends.push_back(std::abs(scan.ranges[i - 1] - 2.0F * scan.ranges[i] + scan.ranges[i + 1]));
  }
  if (bends.empty()) return 0.0F;
  const auto middle = bends.begin() + static_cast<std::ptrdiff_t>(bends.size() / 2);
  std::nth_element(bends.begin(), middle, bends.end());
  constexpr float kMedianOfBend = 1.65F;  // of three normal errors, for a standard deviation of one
  return *middle / kMedianOfBend;
}

/// @param noise  standard deviation of the ranges [m]
bool is_same(float a, float b, float noise) {
  return a < kFarthestM && b < kFarthestM &&
         std::abs(a - b) < std::max(kSameM, kSameSigmas * noise) + kSameShare * std::min(a, b);
}

double share_changed(const Bins& a, const Bins& b) {
  std::size_t both = 0, changed = 0;
  for (std::size_t k = 0; k < kBodyBins; ++k) {
    if (a[k] == kNone || b[k] == kNone) continue;
    ++both;
    changed += std::abs(a[k] - b[k]) > kChangedM + kSameShare * std::min(a[k], b[k]);
  }
  return both > 0 ? static_cast<double>(changed) / static_cast<double>(both) : 0.0;
}

Scan without_bins(const Scan& scan, const std::array<bool, kBodyBins>& out) {
  Scan left = scan;
  for (std::size_t i = 0; i < left.size(); ++i) {
    if (left.is_hit(i) && out[bin_of(left.angle(i))]) left.miss(i, BeamState::kInvalid);
  }
  return left;
}

/// Whether a scan looked through a place that is at a direction and range as seen from its sensor.
bool looked_through(const Bins& bins, double x, double y) {
  const double range = std::hypot(x, y);
  const std::size_t k = bin_of(std::atan2(y, x));
  for (const std::size_t j : {(k + kBodyBins - 1) % kBodyBins, k, (k + 1) % kBodyBins}) {
    if (bins[j] == kNone || static_cast<double>(bins[j]) < range + kThroughM) return false;
  }
  return true;
}

/// Votes of a pair of which the motion is known.
void vote(const Bins& before, const Bins& now, float noise, const Pose2& T_before_now, OwnBodyState& state) {
  const Pose2 T_now_before = T_before_now.inverse();
  for (std::size_t k = 0; k < kBodyBins; ++k) {
    if (before[k] == kNone || now[k] == kNone) continue;
    BodyVotes& votes = state.votes[k];
    ++votes.seen;
    if (!is_same(before[k], now[k], noise)) continue;
    ++votes.same;
    const double angle = static_cast<double>(k) * kTwoPi / kBodyBins, c = std::cos(angle), s = std::sin(angle);
    const auto from = [&](const Pose2& T, double r) {
      const double x = r * c, y = r * s, ct = std::cos(T.theta), st = std::sin(T.theta);
      return std::pair{ct * x - st * y + T.x, st * x + ct * y + T.y};
    };
    const auto [bx, by] = from(T_before_now, static_cast<double>(now[k]));
    const auto [nx, ny] = from(T_now_before, static_cast<double>(before[k]));
    votes.contradicted += looked_through(before, bx, by) || looked_through(now, nx, ny);
  }
}

bool always_same(const BodyVotes& votes, std::size_t pairs) {
  return 3 * votes.seen >= pairs && votes.same >= kSameShareOfPairs * static_cast<double>(votes.seen) &&
         votes.same >= kContradicted;
}

/// A direction that hardly any pair saw, and that never changed where one did.
bool says_little(const BodyVotes& votes, std::size_t pairs) {
  return 3 * votes.seen < pairs && votes.same == votes.seen;
}

/// Runs of directions that never change, in which enough contradict the scene. What hardly any pair saw there does
/// not end them.
std::vector<BodySector> sectors_of(const OwnBodyState& state) {
  std::array<bool, kBodyBins> body{};
  for (std::size_t k = 0; k < kBodyBins; ++k) body[k] = always_same(state.votes[k], state.pairs);
  const auto at = [](std::size_t k, int step) {
    return (k + 2 * kBodyBins + static_cast<std::size_t>(step)) % kBodyBins;
  };
  const std::array<bool, kBodyBins> same = body;
  for (std::size_t k = 0; k < kBodyBins; ++k) {
    for (int gap = 1; same[k] && gap <= kGapBins && says_little(state.votes[at(k, gap)], state.pairs); ++gap) {
      if (!same[at(k, gap + 1)]) continue;
      for (int j = 1; j <= gap; ++j) body[at(k, j)] = true;
    }
  }
  std::vector<BodySector> sectors;
  constexpr double kBin = kTwoPi / kBodyBins;
  for (std::size_t k = 0; k < kBodyBins; ++k) {
    if (!body[k] || body[at(k, -1)]) continue;
    int width = 0, contradicted = 0;
    for (; width < static_cast<int>(kBodyBins) && body[at(k, width)]; ++width)
      contradicted += state.votes[at(k, width)].contradicted >= kContradicted;
    if (contradicted < kLeastBins) continue;
    const double from = (static_cast<double>(k) - 0.5 - kEdgeBins) * kBin;
    sectors.push_back({wrap_angle(from), wrap_angle(from + (width + 2.0 * kEdgeBins) * kBin)});
  }
  return sectors;
}

/// Something is the same in all pairs so far, and contradicts the scene in some.
bool is_suspect(const OwnBodyState& state) {
  return std::count_if(state.votes.begin(), state.votes.end(), [&](const BodyVotes& v) {
           return v.contradicted >= 1 && always_same(v, state.pairs);
         }) >= kLeastBins;
}

}  // namespace

std::string format_sectors(const std::vector<BodySector>& sectors) {
  std::string text;
  for (const BodySector& s : sectors) {
    text += (text.empty() ? "" : ", ") + std::to_string(std::lround(rad_to_deg(s.from))) + " to " +
            std::to_string(std::lround(rad_to_deg(s.to))) + " deg";
  }
  return text;
}

Scan without_sectors(const Scan& scan, const std::vector<BodySector>& sectors) {
  Scan left = scan;
  for (std::size_t i = 0; i < left.size(); ++i) {
    const double angle = left.angle(i);
    const bool inside = std::any_of(sectors.begin(), sectors.end(), [&](const BodySector& s) {
      return wrap_positive(angle - s.from) <= wrap_positive(s.to - s.from);
    });
    if (inside) left.miss(i, BeamState::kInvalid);
  }
  return left;
}

bool OwnBody::add(const Scan& scan, OwnBodyState& state) {
  if (state.decided) return false;
  if (!state.reference) {
    state.reference = scan;
    return false;
  }
  if (state.wait > 0) {
    --state.wait;
    return false;
  }
  Bins before, now;
  fill_bins(*state.reference, before);
  fill_bins(scan, now);
  // A single scan that differs is one with lost packets or a wrong start angle more often than one that moved: what
  // differs twice in a row has moved.
  if (share_changed(before, now) < kChangedShare) {
    state.wait = 0;
    return false;
  }
  if (state.wait != kDifferedOnce) {
    state.wait = kDifferedOnce;
    return false;
  }
  state.wait = 0;
  const float noise = std::max(noise_of(*state.reference), noise_of(scan));
  std::array<bool, kBodyBins> same{};
  for (std::size_t k = 0; k < kBodyBins; ++k) same[k] = is_same(before[k], now[k], noise);
  const MatchResult match = matcher_.match(without_bins(*state.reference, same), without_bins(scan, same));
  const Pose2& moved = match.T_ref_scan;
  if (match.usable && std::hypot(moved.x, moved.y) < kLeastMoveM && std::abs(moved.theta) < kLeastMoveRad) {
    state.wait = kWaitScans;
    return false;
  }
  ++state.tried;
  if (match.usable) {
    ++state.pairs;
    vote(before, now, noise, moved, state);
  }
  state.reference = scan;
  const bool last = state.pairs >= kMostPairs || state.tried >= kMostTries;
  if (state.pairs >= kPairs || last) {
    state.sectors = sectors_of(state);
    state.decided = last || !state.sectors.empty() || !is_suspect(state);
  }
  if (state.decided) state.reference.reset();
  return state.decided;
}

}  // namespace phasescan
