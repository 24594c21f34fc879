#include "fft_icp/missing/missing.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "phasescan/core/pose2.hpp"

namespace phasescan {

double MissingRun::centre() const {
  return wrap_angle(start + 0.5 * width);
}

void MissingFinder::lay_out(const Scan& scan, double dmax_m) {
  cells_.clear();
  full_turn_ = false;
  const std::size_t n = scan.size();
  if (n == 0) return;
  const auto dmax = static_cast<float>(dmax_m);
  const auto missing = [&](std::size_t i) { return !scan.is_hit(i) || (dmax_m > 0.0 && scan.ranges[i] > dmax); };
  cells_.reserve(n);

  if (scan.angles.empty()) {
    const double step = std::abs(scan.geometry.angle_increment);
    if (n < 2 || !(step > 0.0)) return;
    const bool clockwise = scan.geometry.angle_increment < 0.0;
    const auto turn = static_cast<std::size_t>(std::max(1.0, std::min(1e9, std::round(kTwoPi / step))));
    const std::size_t used = std::min(n, turn);
    full_turn_ = static_cast<double>(used) * step > kTwoPi - 1.5 * step;
    for (std::size_t k = 0; k < used; ++k) {
      const std::size_t i = clockwise ? used - 1 - k : k;
      const double angle = scan.angle(i);
      cells_.push_back({angle - 0.5 * step, angle + 0.5 * step, missing(i)});
    }
  } else {
    angles_.resize(n);
    for (std::size_t i = 0; i < n; ++i) angles_[i] = wrap_positive(scan.angle(i));
    order_.resize(n);
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::sort(order_.begin(), order_.end(),
              [&](std::size_t a, std::size_t b) { return angles_[a] != angles_[b] ? angles_[a] < angles_[b] : a < b; });
    // A gap of several beams is a border of the field of view, not a wide beam. Even spacing would be 2 pi / n or less.
    const double widest = 6.0 * kTwoPi / static_cast<double>(std::max<std::size_t>(n, 24));
    bool open = false;
    for (std::size_t k = 0; k < n; ++k) {
      const double angle = angles_[order_[k]];
      double before = angle - angles_[order_[(k + n - 1) % n]], after = angles_[order_[(k + 1) % n]] - angle;
      if (k == 0) before += kTwoPi;
      if (k + 1 == n) after += kTwoPi;
      open = open || after > widest;
      if (before > widest) before = after > widest ? 0.0 : after;
      if (after > widest) after = before;
      cells_.push_back({angle - 0.5 * before, angle + 0.5 * after, missing(order_[k])});
    }
    full_turn_ = !open;
  }
  // The seam of a full turn closes exactly, whatever the rounding of the increment.
  if (full_turn_) {
    const double seam = 0.5 * (cells_.front().start + cells_.back().end - kTwoPi);
    cells_.front().start = seam;
    cells_.back().end = seam + kTwoPi;
  }
}

void MissingFinder::find(const Scan& scan, double dmax_m, double min_width_rad, MissingFeatures& out) {
  out.runs.clear();
  out.size = 0.0;
  lay_out(scan, dmax_m);
  out.full_turn = full_turn_;
  const std::size_t n = cells_.size();
  if (n == 0) return;

  // On a full turn the walk begins at a hit, so that no run is cut by the seam.
  std::size_t first = 0;
  if (full_turn_) {
    while (first < n && cells_[first].missing) ++first;
    if (first == n) {
      out.runs.push_back({wrap_angle(cells_.front().start), kTwoPi});
      out.size = kTwoPi;
      return;
    }
  }
  const auto close = [&](double start, double end) {
    const double width = end - start;
    if (width > 0.0 && width >= min_width_rad) {
      out.runs.push_back({wrap_angle(start), width});
      out.size += width;
    }
  };
  bool inside = false;
  double start = 0.0, end = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t i = first + k < n ? first + k : first + k - n;
    const double turn = first + k < n ? 0.0 : kTwoPi;
    const Cell& cell = cells_[i];
    // A border of the field of view ends a run; 1e-6 forgives rounding of the angles.
    if (inside && (!cell.missing || cell.start + turn > end + 1e-6)) {
      close(start, end);
      inside = false;
    }
    if (!cell.missing) continue;
    if (!inside) start = cell.start + turn;
    inside = true;
    end = cell.end + turn;
  }
  if (inside) close(start, end);
}

}  // namespace phasescan
