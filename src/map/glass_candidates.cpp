#include "map/glass_candidates.hpp"

#include <algorithm>
#include <cmath>

#include "phasescan/core/pose2.hpp"

namespace phasescan {
namespace {

constexpr double kPieceReachM = 12.0;  // farther off a scan says too little of a surface
constexpr int kLostBeams = 3;          // a straight piece may lack so many in a row
constexpr double kMinPieceM = 0.05;
constexpr double kWidestFacet = deg_to_rad(35.0);    // seen under more than this: a surface like others
constexpr double kMostIncidence = deg_to_rad(68.0);  // beyond it any surface may fail to answer
constexpr int kBeamsBeside = 7, kLeastBeside = 3;
constexpr double kSameLineM = 0.08, kSameLineRad = deg_to_rad(12.0), kSamePlaceM = 1.0;
constexpr double kWidestGapM = 4.0, kNarrowestGapM = 0.15, kFlankM = 0.15;

double on_piece(double range) {
  return 0.03 + 0.02 * range;
}

}  // namespace

void GlassCandidates::add(const std::vector<ViewRay>& rays, double step_rad) {
  find_pieces(rays, step_rad);
  for (const Piece& piece : pieces_) look_for_facet(rays, piece);
  for (std::size_t i = 1; i < pieces_.size(); ++i) look_for_gap(rays, pieces_[i - 1], pieces_[i]);
}

void GlassCandidates::find_pieces(const std::vector<ViewRay>& rays, double step_rad) {
  pieces_.clear();
  run_.clear();
  const auto close = [&] {
    if (run_.size() >= 3) split(rays, 0, run_.size() - 1);
    run_.clear();
  };
  for (int b = 0; b < static_cast<int>(rays.size()); ++b) {
    const ViewRay& ray = rays[static_cast<std::size_t>(b)];
    if (ray.end != RayEnd::kHit || ray.range > kPieceReachM) continue;
    if (!run_.empty()) {
      const double range = rays[static_cast<std::size_t>(run_.back())].range;
      const int beams = b - run_.back();
      const double most = 0.06 + 0.02 * range + 2.0 * range * step_rad * beams;
      if (beams > kLostBeams || std::abs(ray.range - range) > most) close();
    }
    run_.push_back(b);
  }
  close();
}

void GlassCandidates::split(const std::vector<ViewRay>& rays, std::size_t from, std::size_t to) {
  if (to < from + 2) return;
  const auto ray_at = [&](std::size_t i) -> const ViewRay& { return rays[static_cast<std::size_t>(run_[i])]; };
  const Eigen::Vector2d a = ray_at(from).point(), b = ray_at(to).point();
  MapLine chord;
  chord.at = a;
  if ((b - a).norm() > 1e-9) chord.along = (b - a).normalized();
  double most = 0.0;
  std::size_t at = from;
  for (std::size_t i = from + 1; i < to; ++i) {
    const double off = std::abs(chord.offset(ray_at(i).point())) / on_piece(ray_at(i).range);
    if (off > most) most = off, at = i;
  }
  if (most > 1.0) {
    split(rays, from, at);
    split(rays, at, to);
    return;
  }
  Piece piece;
  piece.first = run_[from];
  piece.last = run_[to];
  for (std::size_t i = from; i <= to; ++i) piece.sums.add(ray_at(i).point());
  piece.line = piece.sums.line();
  if ((b - a).norm() >= kMinPieceM) pieces_.push_back(piece);
}

void GlassCandidates::look_for_facet(const std::vector<ViewRay>& rays, const Piece& piece) {
  double least = kPi, most = 0.0;
  for (int b = piece.first; b <= piece.last; ++b) {
    const Meeting m = meet(rays[static_cast<std::size_t>(b)], piece.line);
    if (!m.meets) continue;
    least = std::min(least, m.incidence());
    most = std::max(most, m.incidence());
  }
  if (least > deg_to_rad(options_.facing_deg) || most > kWidestFacet) return;
  // On one side at least the line goes on where beams do not end on it.
  bool open = false;
  for (const int side : {-1, 1}) {
    int beside = 0;
    const int end = side < 0 ? piece.first : piece.last;
    for (int d = 2; d < 2 + kBeamsBeside; ++d) {
      const int b = end + side * d;
      if (b < 0 || b >= static_cast<int>(rays.size())) break;
      const ViewRay& ray = rays[static_cast<std::size_t>(b)];
      const Meeting m = meet(ray, piece.line);
      if (!m.meets || m.incidence() > kMostIncidence) break;
      beside += ray.end == RayEnd::kVanished || (ray.end == RayEnd::kHit && m.behind > kThroughM);
    }
    open = open || beside >= kLeastBeside;
  }
  if (open)
    put(piece.sums, rays[static_cast<std::size_t>(piece.first)].point(),
        rays[static_cast<std::size_t>(piece.last)].point(), false);
}

void GlassCandidates::look_for_gap(const std::vector<ViewRay>& rays, const Piece& before, const Piece& after) {
  const int beams = after.first - before.last - 1;
  if (beams < 3) return;
  for (int b = before.last + 1; b < after.first; ++b) {
    if (rays[static_cast<std::size_t>(b)].end == RayEnd::kHit) return;
  }
  const Eigen::Vector2d a = rays[static_cast<std::size_t>(before.last)].point(),
                        b = rays[static_cast<std::size_t>(after.first)].point();
  const Eigen::Vector2d start = rays[static_cast<std::size_t>(before.first)].point(),
                        end = rays[static_cast<std::size_t>(after.last)].point();
  const double width = (b - a).norm(), range = rays[static_cast<std::size_t>(before.last)].range;
  if (width < kNarrowestGapM || width > kWidestGapM || (a - start).norm() < kFlankM || (end - b).norm() < kFlankM)
    return;
  LineSums sums = before.sums;
  sums.add(after.sums);
  const MapLine line = sums.line();
  for (const Eigen::Vector2d& p : {start, a, b, end}) {
    if (std::abs(line.offset(p)) > on_piece(range)) return;
  }
  for (const int beam : {before.last, after.first}) {
    const Meeting m = meet(rays[static_cast<std::size_t>(beam)], line);
    if (!m.meets || m.incidence() > kMostIncidence) return;
  }
  put(sums, a, b, true);
}

void GlassCandidates::put(const LineSums& sums, const Eigen::Vector2d& from, const Eigen::Vector2d& to, bool gap) {
  const MapLine line = sums.line();
  for (GlassCandidate& c : found_) {
    if (c.gap != gap) continue;
    const double a = c.line.place(from), b = c.line.place(to);
    const double low = std::min(a, b), high = std::max(a, b);
    if (low > c.high + kSamePlaceM || high < c.low - kSamePlaceM) continue;
    if (std::abs(c.line.offset(from)) > 2.0 * kSameLineM || std::abs(c.line.offset(to)) > 2.0 * kSameLineM ||
        std::abs(c.line.offset(0.5 * (from + to))) > kSameLineM)
      continue;
    if (std::abs(c.line.normal().dot(line.along)) > std::sin(kSameLineRad) && (to - from).norm() > 0.2) continue;
    const Eigen::Vector2d ends[4] = {c.line.at + c.low * c.line.along, c.line.at + c.high * c.line.along, from, to};
    c.sums.add(sums);
    c.line = c.sums.line();
    c.low = 1e300, c.high = -1e300;
    for (const Eigen::Vector2d& p : ends) {
      c.low = std::min(c.low, c.line.place(p));
      c.high = std::max(c.high, c.line.place(p));
    }
    ++c.views;
    return;
  }
  GlassCandidate c;
  c.sums = sums;
  c.line = line;
  c.low = std::min(line.place(from), line.place(to));
  c.high = std::max(line.place(from), line.place(to));
  c.views = 1;
  c.gap = gap;
  found_.push_back(c);
}

std::vector<GlassCandidate> GlassCandidates::take() {
  std::vector<GlassCandidate> out;
  for (const GlassCandidate& c : found_) {
    if (c.views >= 3 && c.high - c.low > 0.2) out.push_back(c);
  }
  found_.clear();
  return out;
}

}  // namespace phasescan
