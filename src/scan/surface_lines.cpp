#include "scan/surface_lines.hpp"

#include <algorithm>
#include <cmath>

#include "scan/surface_lines_kernel.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kLinesPadding = 8;

struct LineFit {
  double cx = 0, cy = 0, nx = 0, ny = 0, norm2 = 0;  // centre; normal, not of unit length, and its square
  double spread = 0, residual = 0;                   // variance along and across the line
  int count = 0;

  // Whether the line fits as well as `variance` of the ranges lets expect at (px, py).
  bool fits(double variance, double px, double py) const {
    const double dot = nx * px + ny * py, all = norm2 * (px * px + py * py);
    return residual * all <= variance * std::max(dot * dot, surface_lines::kLeastCosine2 * all);
  }
};

// As the kernel fits lines, for one hit.
LineFit fit_line(const double* sums, int from, int to) {
  const double* a = sums + 5 * static_cast<std::size_t>(from);
  const double* b = sums + 5 * static_cast<std::size_t>(to);
  LineFit fit;
  fit.count = to - from;
  const double inv = 1.0 / fit.count;
  fit.cx = (b[0] - a[0]) * inv;
  fit.cy = (b[1] - a[1]) * inv;
  const double xx = (b[2] - a[2]) * inv - fit.cx * fit.cx;
  const double xy = (b[3] - a[3]) * inv - fit.cx * fit.cy;
  const double yy = (b[4] - a[4]) * inv - fit.cy * fit.cy;
  const double lead = 0.5 * (xx - yy), mean = 0.5 * (xx + yy);
  const double root = std::sqrt(lead * lead + xy * xy);
  fit.spread = mean + root;
  fit.residual = std::max(mean - root, 0.0);
  fit.nx = lead >= 0.0 ? xy : root - lead;
  fit.ny = lead >= 0.0 ? -(lead + root) : -xy;
  fit.norm2 = fit.nx * fit.nx + fit.ny * fit.ny;
  return fit;
}

void sum_up(const SurfacePoints& surface, std::size_t padded, SurfaceWorkspace& work) {
  const std::size_t n = surface.size();
  work.x.assign(padded, 0.0);
  work.y.assign(padded, 0.0);
  work.sums.resize(5 * (padded + 1));
  std::fill_n(work.sums.begin(), 5, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    const double px = work.x[i] = static_cast<double>(surface[i].x), py = work.y[i] = static_cast<double>(surface[i].y);
    const double* last = work.sums.data() + 5 * i;
    double* next = work.sums.data() + 5 * (i + 1);
    next[0] = last[0] + px;
    next[1] = last[1] + py;
    next[2] = last[2] + px * px;
    next[3] = last[3] + px * py;
    next[4] = last[4] + py * py;
  }
  std::fill(work.sums.begin() + static_cast<std::ptrdiff_t>(5 * (n + 1)), work.sums.end(), 0.0);
}

// A line through few neighbours: at a corner of the side that it fits better, and longer where it may be.
LineFit fit_short_line(const SurfaceWorkspace& work, std::size_t hit, double expected, double straightness) {
  const int i = static_cast<int>(hit), half = work.half[hit];
  const auto fit = [&](int back, int on) {
    return fit_line(work.sums.data(), std::max(work.segment_begin[hit], i - back),
                    std::min(work.segment_end[hit], i + on + 1));
  };
  const double px = work.x[hit], py = work.y[hit];
  int back = half, on = half;
  LineFit best = fit(back, on);
  if (!best.fits(1.5 * expected, px, py)) {
    for (const bool before : {true, false}) {
      const LineFit side = fit(before ? 2 * half : 0, before ? 0 : 2 * half);
      if (side.count < 3 || side.residual >= 0.6 * best.residual) continue;
      best = side;
      back = before ? 2 * half : 0;
      on = before ? 0 : 2 * half;
    }
  }
  const LineFit longer = fit(2 * back, 2 * on);
  return best.count >= 3 && longer.fits(straightness * expected, px, py) ? longer : best;
}

}  // namespace

void find_lines(double straightness, double least_spread, SurfaceWorkspace& work, SurfacePoints& out) {
  using namespace surface_lines;
  const std::size_t n = out.size(), padded = (n + kLinesPadding - 1) / kLinesPadding * kLinesPadding;
  sum_up(out, padded, work);
  for (auto* v : {&work.segment_begin, &work.segment_end}) v->resize(padded, 0);
  for (auto* v : {&out.range, &out.sigma}) v->resize(padded, 1.0F);
  work.half.resize(padded);
  work.lines.resize(kLineFields * padded);
  work.found.resize(padded);
  work.hits.resize(kHitFields * padded);
  const LinesTask task{work.sums.data(),
                       work.x.data(),
                       work.y.data(),
                       out.range.data(),
                       out.sigma.data(),
                       work.segment_begin.data(),
                       work.segment_end.data(),
                       padded,
                       out.spacing,
                       kReachShare * out.extent,
                       straightness,
                       least_spread,
                       work.half.data(),
                       work.lines.data(),
                       work.hits.data(),
                       work.found.data()};
  fit_long_lines(task);
  for (std::size_t i = 0; i < n; ++i) {
    if (work.found[i] != 0 || work.segment_end[i] - work.segment_begin[i] < 3) continue;
    const double sigma = static_cast<double>(out.sigma[i]);
    const LineFit line = fit_short_line(work, i, sigma * sigma, straightness);
    double* field = work.lines.data() + i;
    for (const double value : {line.cx, line.cy, line.nx, line.ny, line.norm2, line.spread, line.residual,
                               static_cast<double>(line.count)}) {
      *field = value;
      field += padded;
    }
  }
  finish_hits(task);
  for (auto* v : {&out.range, &out.sigma}) v->resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const float* field = work.hits.data() + i;
    const auto get = [&](HitField f) { return field[static_cast<std::size_t>(f) * padded]; };
    SurfacePoint& point = out.points[i];
    point.line_x = get(kHitLineX);
    point.line_y = get(kHitLineY);
    point.nx = get(kHitNx);
    point.ny = get(kHitNy);
    point.length = get(kHitLength);
    point.variance = get(kHitVariance);
  }
  const float* turns = work.hits.data() + kHitNormalVariance * padded;
  std::copy(turns, turns + n, out.normal_variance.begin());
}

}  // namespace phasescan
