#include "fft_icp/missing/from_missing.hpp"

#include <algorithm>
#include <cmath>

#include "phasescan/core/pose2.hpp"

namespace phasescan {
namespace {

/// Width of the overlap of [0, a] and [shift, shift + b] on the circle; a, b <= 2 pi.
double circular_overlap(double a, double b, double shift) {
  shift = wrap_positive(shift);
  double sum = 0.0;
  for (const double turn : {-kTwoPi, 0.0, kTwoPi}) {
    sum += std::max(0.0, std::min(a, shift + turn + b) - std::max(0.0, shift + turn));
  }
  return sum;
}

double total_overlap(const MissingFeatures& reference, const MissingFeatures& scan, double alpha) {
  double sum = 0.0;
  for (const MissingRun& r : reference.runs) {
    for (const MissingRun& s : scan.runs) sum += circular_overlap(r.width, s.width, s.start + alpha - r.start);
  }
  return sum;
}

constexpr double kApart = 15.0 * kPi / 180.0;

}  // namespace

double missing_error(const MissingFeatures& reference, const MissingFeatures& scan, double alpha) {
  const double size = reference.size + scan.size;
  return size > 0.0 ? std::clamp((size - 2.0 * total_overlap(reference, scan, alpha)) / size, 0.0, 1.0) : 1.0;
}

MissingRotation MissingMatcher::match(const MissingFeatures& reference, const MissingFeatures& scan,
                                      const MissingOptions& options) {
  MissingRotation best;
  if (reference.runs.empty() || scan.runs.empty()) return best;
  const double size = reference.size + scan.size;

  // The overlap of a reference run [a, a + wa] with a scan run [b + alpha, b + alpha + wb] rises from alpha = a - b -
  // wb, is flat between a - b and a - b + wa - wb (whichever comes first), falls, and is over at a - b + wa.
  bends_.clear();
  for (const MissingRun& r : reference.runs) {
    for (const MissingRun& s : scan.runs) {
      const double meet = r.start - s.start;
      bends_.push_back({wrap_positive(meet - s.width), 1.0});
      bends_.push_back({wrap_positive(meet), -1.0});
      bends_.push_back({wrap_positive(meet + r.width - s.width), -1.0});
      bends_.push_back({wrap_positive(meet + r.width), 1.0});
    }
  }
  std::sort(bends_.begin(), bends_.end(),
            [](const Bend& a, const Bend& b) { return a.alpha != b.alpha ? a.alpha < b.alpha : a.slope < b.slope; });

  // Walk around the circle: exact value and slope at the first bend, then bend by bend.
  const std::size_t m = bends_.size();
  overlap_.resize(m);
  overlap_[0] = total_overlap(reference, scan, bends_[0].alpha);
  // A slope that fits: after all bends the walk must be back at its start.
  double drift = 0.0, slope = 0.0;
  for (std::size_t k = 0; k < m; ++k) {
    slope += bends_[k].slope;
    const double next = k + 1 < m ? bends_[k + 1].alpha : bends_[0].alpha + kTwoPi;
    drift += slope * (next - bends_[k].alpha);
  }
  slope = -drift / kTwoPi;
  for (std::size_t k = 0; k + 1 < m; ++k) {
    slope += bends_[k].slope;
    overlap_[k + 1] = overlap_[k] + slope * (bends_[k + 1].alpha - bends_[k].alpha);
  }

  const double most = *std::max_element(overlap_.begin(), overlap_.end());
  constexpr double kSame = 1e-9;
  const auto is_best = [&](std::size_t k) { return overlap_[k % m] >= most - kSame; };
  // The first plateau: from a best bend whose predecessor is not one, through all best bends after it.
  std::size_t from = 0;
  while (from < m && !(is_best(from) && !is_best(from + m - 1))) ++from;
  if (from == m) return best;  // the same overlap at every rotation: no direction in it
  std::size_t to = from;
  while (is_best(to + 1)) ++to;
  const double begin = bends_[from].alpha;
  const double length = bends_[to % m].alpha + (to >= m ? kTwoPi : 0.0) - begin;
  best.theta = wrap_angle(begin + 0.5 * length);
  best.error = std::clamp((size - 2.0 * most) / size, 0.0, 1.0);

  double other = 0.0;
  for (std::size_t k = 0; k < m; ++k) {
    if (angle_distance(bends_[k].alpha, best.theta) > 0.5 * length + kApart) other = std::max(other, overlap_[k]);
  }
  // Between bends the overlap is straight, so beside the bends only the borders of the excluded arc can be higher.
  if (0.5 * length + kApart < kPi) {
    for (const double side : {-1.0, 1.0}) {
      other = std::max(other, total_overlap(reference, scan, best.theta + side * (0.5 * length + kApart)));
    }
  }
  best.margin = 2.0 * (most - other) / size;

  const double least = deg_to_rad(options.min_size_deg);
  best.accepted = reference.full_turn && scan.full_turn && reference.size > least && scan.size > least &&
                  best.error <= options.max_error && best.margin >= options.min_margin;
  return best;
}

}  // namespace phasescan
