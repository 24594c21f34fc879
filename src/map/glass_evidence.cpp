#include "map/glass_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "phasescan/core/pose2.hpp"

namespace phasescan {
namespace {

constexpr double kBinM = 0.1, kBesideM = 0.7;  // the line is looked at so far beyond what was seen of it
constexpr double kEvidenceReachM = 10.0;
constexpr double kMostOblique = deg_to_rad(66.0);  // beyond it any surface may fail to answer
constexpr double kFacingFrom = deg_to_rad(20.0);   // hits up to here are an answer head on, if not a clean one
constexpr double kVanishShare = 0.5;               // of the range up to which a surface should have answered
constexpr double kBehindShare = 0.8;               // the same of what stands behind
constexpr double kNearShare = 0.4;                 // a black surface answers from nearer than this
constexpr double kShellM = 0.25;
constexpr double kKnownBehind = 2.0;    // log-odds of what surely stands there
constexpr double kWallBesideM = 0.6;    // so near to a gap its wall must be seen
constexpr double kMostLike = 0.15;      // share of beams that may say otherwise
constexpr double kExpectedShare = 0.6;  // of the beams that vanished: known to have something to end on behind
constexpr int kBlackOdds = 4;  // of what was answered head on, so many vanish for each that went through: not glass
constexpr std::size_t kJoinBins = 3, kGrowBins = 5;
constexpr double kWayM = 0.4;  // the sensor moved so far along the line while it saw the surface
constexpr int kSeen = 3;
constexpr double kSureShare = 0.35;  // oblique beams that went on, for each one that was answered

double on_pane(double range) {
  return 0.05 + 0.015 * range;
}

}  // namespace

void GlassEvidence::Bin::pool(const Bin& o) {
  facing_hits += o.facing_hits, facing_open += o.facing_open, oblique_hits += o.oblique_hits;
  oblique_through += o.oblique_through, oblique_vanished += o.oblique_vanished;
  oblique_scans = std::max(oblique_scans, o.oblique_scans);
  hits += o.hits, through += o.through;
  expected += o.expected;
  expected_scans = std::max(expected_scans, o.expected_scans);
  for (std::size_t s = 0; s < kShells; ++s) {
    hits_at[s] += o.hits_at[s], vanished_at[s] += o.vanished_at[s];
    scans_at[s] = std::max(scans_at[s], o.scans_at[s]);
  }
}

int GlassEvidence::Bin::vanished() const {
  return std::accumulate(vanished_at.begin(), vanished_at.end(), 0);
}

GlassEvidence::GlassEvidence(const GlassCandidate& candidate, const GlassOptions& options)
    : candidate_(candidate), options_(options) {
  start_ = candidate.low - kBesideM;
  bins_.resize(static_cast<std::size_t>(std::ceil((candidate.high - candidate.low + 2.0 * kBesideM) / kBinM)));
}

void GlassEvidence::add(const std::vector<ViewRay>& rays, double range_max, const OccupancyGrid& grid) {
  if (rays.empty()) return;
  const Eigen::Vector2d middle = at(0.5 * (candidate_.low + candidate_.high));
  const double half = 0.5 * kBinM * static_cast<double>(bins_.size());
  if ((rays.front().from - middle).norm() > kEvidenceReachM + half) return;
  met_.clear();
  for (const ViewRay& ray : rays) {
    if (ray.end == RayEnd::kUnknown) continue;
    const Meeting m = meet(ray, candidate_.line);
    if (!m.meets || m.range > kEvidenceReachM || m.place < start_) continue;
    const auto bin = static_cast<std::size_t>((m.place - start_) / kBinM);
    if (bin >= bins_.size()) continue;
    // What ends in front of the line says nothing of it.
    if (ray.end == RayEnd::kHit && m.behind < -on_pane(m.range)) continue;
    met_.push_back({m, m.incidence(), &ray, bin});
  }
  if (met_.empty()) return;
  if (candidate_.gap)
    count_gap(range_max, grid);
  else
    count_facing(range_max);
}

void GlassEvidence::count_facing(double range_max) {
  const double facing = deg_to_rad(options_.facing_deg), oblique = deg_to_rad(options_.oblique_deg);
  Witness witness{0.0, 1e300, -1e300};
  int answers = 0;
  for (const Met& m : met_) {
    if (m.ray->end != RayEnd::kHit || m.at.behind > on_pane(m.at.range) || m.incidence > kFacingFrom) continue;
    ++answers;
    witness.place = candidate_.line.place(m.ray->from);
    witness.low = std::min(witness.low, m.at.place);
    witness.high = std::max(witness.high, m.at.place);
  }
  const bool is_witness = answers >= 2;
  if (is_witness) witnesses_.push_back(witness);
  std::size_t last = bins_.size();
  for (const Met& m : met_) {
    Bin& bin = bins_[m.bin];
    const bool hit = m.ray->end == RayEnd::kHit;
    const bool on = hit && m.at.behind <= on_pane(m.at.range), through = hit && m.at.behind > kThroughM;
    const bool vanished = !hit && m.at.range < kVanishShare * range_max;
    bin.hits += on;
    if (m.incidence <= facing) {
      bin.facing_hits += on;
      bin.facing_open += through || vanished;
    }
    if (m.incidence < oblique || m.incidence > kMostOblique) continue;
    bin.oblique_hits += on;
    if (!is_witness || !(through || vanished)) continue;
    bin.oblique_through += through;
    bin.oblique_vanished += vanished;
    if (m.bin != last) ++bin.oblique_scans;
    last = m.bin;
  }
}

void GlassEvidence::count_gap(double range_max, const OccupancyGrid& grid) {
  bool wall_below = false, wall_above = false;
  for (const Met& m : met_) {
    if (m.ray->end != RayEnd::kHit || m.at.behind > on_pane(m.at.range)) continue;
    wall_below = wall_below || (m.at.place < candidate_.low && m.at.place > candidate_.low - kWallBesideM);
    wall_above = wall_above || (m.at.place > candidate_.high && m.at.place < candidate_.high + kWallBesideM);
  }
  range_max_ = std::max(range_max_, range_max);
  Witness witness{0.0, 1e300, -1e300};
  std::size_t last = bins_.size(), last_expected = bins_.size();
  for (const Met& m : met_) {
    Bin& bin = bins_[m.bin];
    if (m.incidence > kMostOblique) continue;
    const auto shell = static_cast<std::size_t>(m.at.range / kShellM);
    if (shell >= kShells) continue;
    if (m.ray->end == RayEnd::kHit) {
      if (m.at.behind <= on_pane(m.at.range)) ++bin.hits, ++bin.hits_at[shell];
      bin.through += m.at.behind > kThroughM;
      continue;
    }
    if (!wall_below || !wall_above || m.at.range > kVanishShare * range_max) continue;
    ++bin.vanished_at[shell];
    witness.place = candidate_.line.place(m.ray->from);
    witness.low = std::min(witness.low, m.at.place);
    witness.high = std::max(witness.high, m.at.place);
    if (m.bin != last) ++bin.scans_at[shell];
    last = m.bin;
    const double left = kBehindShare * range_max - m.at.range - kThroughM;
    const Eigen::Vector2d behind = m.ray->from + (m.at.range + kThroughM) * m.ray->direction;
    const double direction = std::atan2(m.ray->direction.y(), m.ray->direction.x());
    if (left > 0.0 && grid.raycast(behind, direction, left, kKnownBehind)) {
      ++bin.expected;
      if (m.bin != last_expected) ++bin.expected_scans;
      last_expected = m.bin;
    }
  }
  if (witness.high >= witness.low) witnesses_.push_back(witness);
}

GlassEvidence::Bin GlassEvidence::pooled(std::size_t i) const {
  Bin sum = bins_[i];
  if (i > 0) sum.pool(bins_[i - 1]);
  if (i + 1 < bins_.size()) sum.pool(bins_[i + 1]);
  return sum;
}

bool GlassEvidence::passable(const Bin& b) const {
  const int passed = b.oblique_through + b.oblique_vanished;
  return passed >= kSeen && b.oblique_scans >= 2 && b.oblique_hits <= kMostLike * (passed + b.oblique_hits);
}

bool GlassEvidence::is_glass(const Bin& b) const {
  return b.facing_hits >= 2 && b.facing_hits >= 2 * b.facing_open && passable(b);
}

bool GlassEvidence::answers_near_only(const Bin& b) const {
  // Up to some range beams come back, beyond it hardly any does.
  const auto last = std::min(kShells, static_cast<std::size_t>(kNearShare * range_max_ / kShellM));
  int hits_near = 0, vanished_near = 0;
  for (std::size_t far = 1; far <= last; ++far) {
    hits_near += b.hits_at[far - 1];
    vanished_near += b.vanished_at[far - 1];
    int hits_far = 0, vanished_far = 0, scans = 0;
    for (std::size_t s = far; s < kShells; ++s)
      hits_far += b.hits_at[s], vanished_far += b.vanished_at[s], scans += b.scans_at[s];
    if (hits_near >= kSeen && vanished_near <= hits_near && vanished_far >= kSeen && scans >= kSeen &&
        hits_far <= kMostLike * vanished_far)
      return true;
  }
  return false;
}

bool GlassEvidence::is_black(std::size_t i) const {
  const Bin& b = bins_[i];
  const int vanished = b.vanished();
  if (vanished < kSeen || b.through > kMostLike * vanished) return false;
  if (b.expected_scans >= kSeen && b.expected >= kExpectedShare * vanished && b.hits <= kMostLike * vanished)
    return true;
  return answers_near_only(b);
}

void GlassEvidence::grow(std::size_t& from, std::size_t& to) const {
  // The robot did not face all of a pane: it goes on to its frame, where that is near and nothing speaks against it.
  for (const int side : {-1, 1}) {
    std::size_t end = side < 0 ? from : to;
    for (std::size_t d = 1; d <= kGrowBins; ++d) {
      const auto i = static_cast<std::ptrdiff_t>(side < 0 ? from : to) + side * static_cast<std::ptrdiff_t>(d);
      if (i < 0 || i >= static_cast<std::ptrdiff_t>(bins_.size())) break;
      const Bin& bin = bins_[static_cast<std::size_t>(i)];
      if (bin.oblique_hits >= kSeen && bin.oblique_hits > bin.oblique_through + bin.oblique_vanished) {
        (side < 0 ? from : to) = end;
        break;
      }
      if (bin.facing_open > bin.facing_hits) break;
      end = static_cast<std::size_t>(i);
    }
  }
}

GlassPane GlassEvidence::pane(std::size_t from, std::size_t to) const {
  GlassPane out;
  const double low = start_ + kBinM * static_cast<double>(from), high = start_ + kBinM * static_cast<double>(to + 1);
  out.a = at(low);
  out.b = at(high);
  int scans = 0;
  for (std::size_t i = from; i <= to; ++i) {
    const Bin& b = bins_[i];
    out.hits += static_cast<std::size_t>(b.hits);
    out.through += static_cast<std::size_t>(candidate_.gap ? b.through : b.oblique_through);
    out.vanished += static_cast<std::size_t>(candidate_.gap ? b.vanished() : b.oblique_vanished);
    scans = std::max(scans, std::accumulate(b.scans_at.begin(), b.scans_at.end(), 0));
  }
  double first = 1e300, last = -1e300;
  if (candidate_.gap) {
    out.kind = GlassKind::kBlack;
    out.views = static_cast<std::size_t>(scans);
  } else {
    out.kind = kBlackOdds * out.through < out.vanished ? GlassKind::kBlack : GlassKind::kGlass;
  }
  // From one place a thing in front of the line looks like one on it; seen from elsewhere its shadow moves.
  for (const Witness& w : witnesses_) {
    if (w.high < low || w.low > high) continue;
    out.views += !candidate_.gap;
    first = std::min(first, w.place);
    last = std::max(last, w.place);
  }
  const double passed = static_cast<double>(out.through + out.vanished) / std::max(1.0, static_cast<double>(out.hits));
  out.sure = out.views >= static_cast<std::size_t>(options_.min_views) && out.length() >= options_.min_length_m &&
             last - first >= kWayM && (candidate_.gap || passed >= kSureShare);
  return out;
}

std::vector<GlassPane> GlassEvidence::panes() const {
  std::vector<GlassPane> out;
  std::vector<char> is(bins_.size(), 0);
  for (std::size_t i = 0; i < bins_.size(); ++i) {
    is[i] = candidate_.gap ? is_black(i) : is_glass(pooled(i));
  }
  for (std::size_t i = 0; i < is.size(); ++i) {
    if (!is[i]) continue;
    std::size_t last = i;
    for (std::size_t k = i + 1; k < is.size() && k <= last + kJoinBins + 1; ++k) {
      if (is[k]) {
        last = k;
      } else if (const Bin b = pooled(k); candidate_.gap ? b.through > b.vanished() : b.facing_open > b.facing_hits) {
        break;  // open there
      }
    }
    std::size_t from = i, to = last;
    if (!candidate_.gap) grow(from, to);
    const GlassPane found = pane(from, to);
    if (found.views >= 3 && found.length() >= options_.min_length_m) out.push_back(found);
    i = last;
  }
  return out;
}

}  // namespace phasescan
