#include "phasescan/scan/surface.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace phasescan {
namespace {

constexpr int kBeamsPerRestart = 64;  // the rotation recurrence is restarted so often: error below 1e-13
constexpr double kMinFloor = 0.004;   // [m] no lidar of this kind is better than this
constexpr int kMaxHalfWindow = 48;
// A line is fitted this far to either side, short enough for furniture, and farther where the wall runs on.
constexpr double kReachShare = 0.007, kReachSigmas = 1.0;  // of the extent; of the range noise
constexpr int kLonger = 4;
constexpr double kStraight = 1.0;     // of the expected variance across the line: a longer line must fit this well
constexpr double kLeastCosine = 0.1;  // a beam along a wall is not as good as its noise across it says

// The nth smallest of values that are not negative; changes their order. A count by leading bits finds the few that are
// worth a sort.
float nth_smallest(std::vector<float>& values, std::size_t nth) {
  constexpr int kShift = 20, kFirst = 110 << 3, kBuckets = 256;  // eighths of octaves from 8e-6 to 3e4
  const auto bucket_of = [](float value) {
    return std::clamp(static_cast<int>(std::bit_cast<std::uint32_t>(value) >> kShift) - kFirst, 0, kBuckets - 1);
  };
  std::array<std::uint32_t, kBuckets> counts{};
  for (const float value : values) ++counts[static_cast<std::size_t>(bucket_of(value))];
  int bucket = 0;
  for (std::size_t k = 0; nth >= counts[k]; ++k, ++bucket) nth -= counts[k];
  std::size_t kept = 0;
  for (const float value : values) {
    values[kept] = value;
    kept += bucket_of(value) == bucket;
  }
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(nth);
  std::nth_element(values.begin(), at, values.begin() + static_cast<std::ptrdiff_t>(kept));
  return *at;
}

double median_of(std::vector<float>& values) {
  return values.empty() ? 0.0 : static_cast<double>(nth_smallest(values, values.size() / 2));
}

void directions(const Scan& scan, SurfaceWorkspace& work) {
  const std::size_t n = scan.size();
  work.cos_angle.resize(n);
  work.sin_angle.resize(n);
  const bool regular = scan.angles.empty();
  const double step = n > 1 && regular ? work.angle[1] - work.angle[0] : 0.0;
  const double cs = std::cos(step), ss = std::sin(step);
  for (std::size_t i = 0; i < n; ++i) {
    if (!regular || i % kBeamsPerRestart == 0) {
      work.cos_angle[i] = std::cos(work.angle[i]);
      work.sin_angle[i] = std::sin(work.angle[i]);
    } else {
      work.cos_angle[i] = work.cos_angle[i - 1] * cs - work.sin_angle[i - 1] * ss;
      work.sin_angle[i] = work.sin_angle[i - 1] * cs + work.cos_angle[i - 1] * ss;
    }
  }
}

void take_points(const Scan& scan, const Twist2& twist, const SurfaceWorkspace& work, SurfacePoints& out) {
  const bool deskew = !twist.is_zero() && scan.time_increment != 0.0;
  for (std::size_t k = 0; k < work.order.size(); ++k) {
    const auto beam = static_cast<std::size_t>(work.order[k]);
    if (!scan.is_hit(beam)) continue;
    const auto range = static_cast<double>(scan.ranges[beam]);
    double px = range * work.cos_angle[k], py = range * work.sin_angle[k];
    float r = scan.ranges[beam];
    if (deskew) {
      const Eigen::Vector2d p =
          exp_twist(twist, static_cast<double>(beam) * scan.time_increment) * Eigen::Vector2d(px, py);
      px = p.x();
      py = p.y();
      r = static_cast<float>(p.norm());
    }
    SurfacePoint point;
    point.x = point.line_x = static_cast<float>(px);
    point.y = point.line_y = static_cast<float>(py);
    out.points.push_back(point);
    out.range.push_back(r);
    out.beam.push_back(static_cast<int>(k));  // position in `order` for now: neighbours in direction
  }
}

// Range noise from second differences along runs of adjacent beams, near and far halves apart.
RangeNoise estimate_noise(const SurfacePoints& points, SurfaceWorkspace& work) {
  RangeNoise noise{0.01F, 0.01F};
  const std::size_t n = points.size();
  auto& all = work.scratch;
  all.clear();
  for (std::size_t i = 1; i + 1 < n; ++i) {
    if (points.beam[i + 1] - points.beam[i - 1] != 2) continue;
    all.push_back(points.range[i]);
  }
  if (all.size() < 16) return noise;
  const auto split = static_cast<float>(median_of(all));
  constexpr double kToSigma = 1.0 / (0.6745 * 2.4495);  // median |r0 - 2 r1 + r2| of unit noise is 0.6745 sqrt(6)
  double sigma[2], range[2];
  for (int half = 0; half < 2; ++half) {
    work.scratch.clear();
    work.scratch2.clear();
    for (std::size_t i = 1; i + 1 < n; ++i) {
      if (points.beam[i + 1] - points.beam[i - 1] != 2) continue;
      if ((points.range[i] > split) != (half == 1)) continue;
      work.scratch.push_back(std::fabs(points.range[i - 1] - 2.0F * points.range[i] + points.range[i + 1]));
      work.scratch2.push_back(points.range[i]);
    }
    sigma[half] = kToSigma * median_of(work.scratch);
    range[half] = median_of(work.scratch2);
  }
  const double near_floor = std::max(kMinFloor, 0.25 * sigma[1]);
  noise.floor_m = static_cast<float>(std::clamp(sigma[0], near_floor, 0.05 * std::max(range[0], 0.2)));
  const double far_rate = range[1] > 0.0 ? sigma[1] / range[1] : 0.01;
  noise.per_metre = static_cast<float>(std::clamp(far_rate, 0.001, 0.03));
  return noise;
}

// Which hits lie on one surface: a run ends where beams are missing or the surface jumps.
void find_segments(const SurfacePoints& points, double spacing, SurfaceWorkspace& work) {
  const int n = static_cast<int>(points.size());
  work.segment_begin.resize(points.size());
  work.segment_end.resize(points.size());
  int begin = 0;
  for (int i = 0; i < n; ++i) {
    work.segment_begin[i] = begin;
    bool breaks = i + 1 == n;
    if (!breaks) {
      const int gap = points.beam[i + 1] - points.beam[i];
      const float dx = points[i + 1].x - points[i].x, dy = points[i + 1].y - points[i].y;
      const float near = std::min(points.range[i], points.range[i + 1]);
      const float step = static_cast<float>(spacing) * near * static_cast<float>(gap);
      const float limit = 3.0F * step + 4.0F * points.sigma[i];
      breaks = gap > 4 || dx * dx + dy * dy > limit * limit;
    }
    if (breaks) {
      for (int k = begin; k <= i; ++k) work.segment_end[k] = i + 1;
      begin = i + 1;
    }
  }
}

struct LineFit {
  double cx = 0, cy = 0, nx = 0, ny = 0, norm2 = 0;  // centre; normal, not of unit length, and its square
  double spread = 0, residual = 0;                   // variance along and across the line
  int count = 0;

  // Whether the line fits as well as `variance` of the ranges lets expect at (px, py): a beam along the line (less than
  // about 12 deg apart) is given no more credit.
  bool fits(double variance, double px, double py) const {
    const double dot = nx * px + ny * py, all = norm2 * (px * px + py * py);
    return residual * all <= variance * std::max(dot * dot, 0.04 * all);
  }
};

inline LineFit fit_line(const double* sums, int from, int to) {
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
  const double half = 0.5 * (xx - yy), mean = 0.5 * (xx + yy);
  const double root = std::sqrt(half * half + xy * xy);
  fit.spread = mean + root;
  fit.residual = std::max(mean - root, 0.0);
  // Eigenvector of the small eigenvalue, from the better conditioned row.
  fit.nx = half >= 0.0 ? xy : root - half;
  fit.ny = half >= 0.0 ? -(half + root) : -xy;
  fit.norm2 = fit.nx * fit.nx + fit.ny * fit.ny;
  return fit;
}

void find_normals(double spacing, SurfaceWorkspace& work, SurfacePoints& out) {
  const int n = static_cast<int>(out.size());
  work.sums.resize(5 * (out.size() + 1));
  std::fill_n(work.sums.begin(), 5, 0.0);
  for (int i = 0; i < n; ++i) {
    const double px = static_cast<double>(out.points[i].x), py = static_cast<double>(out.points[i].y);
    const double* last = work.sums.data() + 5 * static_cast<std::size_t>(i);
    double* next = work.sums.data() + 5 * static_cast<std::size_t>(i + 1);
    next[0] = last[0] + px;
    next[1] = last[1] + py;
    next[2] = last[2] + px * px;
    next[3] = last[3] + px * py;
    next[4] = last[4] + py * py;
  }
  const double* const sums = work.sums.data();
  for (int i = 0; i < n; ++i) {
    const double r = static_cast<double>(out.range[i]), sigma = static_cast<double>(out.sigma[i]);
    const double px = static_cast<double>(out.points[i].x), py = static_cast<double>(out.points[i].y);
    const double step = std::max(spacing * r, 1e-4);
    const double reach = std::max(kReachShare * out.extent, kReachSigmas * sigma);
    const int half = static_cast<int>(std::clamp(std::ceil(reach / step), 2.0, double{kMaxHalfWindow}));
    const int begin = work.segment_begin[i], end = work.segment_end[i];
    SurfacePoint& point = out.points[i];
    point.variance = static_cast<float>(0.25 * sigma * sigma);
    point.length = static_cast<float>(2.0 * step);
    out.normal_variance[i] = 0.3F;
    if (end - begin < 3) continue;
    const double expected = sigma * sigma;
    const auto fit = [&](int back, int on) {
      return fit_line(sums, std::max(begin, i - back), std::min(end, i + on + 1));
    };
    LineFit best = fit(kLonger * half, kLonger * half);
    if (best.count >= 3 && best.fits(kStraight * expected, px, py)) {
      const LineFit longest = fit(kLonger * kLonger * half, kLonger * kLonger * half);
      if (longest.fits(kStraight * expected, px, py)) best = longest;
    } else {
      int back = half, on = half;
      best = fit(back, on);
      if (!best.fits(1.5 * expected, px, py)) {
        // A corner, perhaps: the side on which the line fits better.
        for (const bool before : {true, false}) {
          const LineFit side = fit(before ? 2 * half : 0, before ? 0 : 2 * half);
          if (side.count < 3 || side.residual >= 0.6 * best.residual) continue;
          best = side;
          back = before ? 2 * half : 0;
          on = before ? 0 : 2 * half;
        }
      }
      const LineFit longer = fit(2 * back, 2 * on);
      if (best.count >= 3 && longer.fits(kStraight * expected, px, py)) best = longer;
    }
    if (best.count < 3 || best.spread < 4.0 * best.residual || best.spread <= 0.0) continue;
    const double unit = 1.0 / std::sqrt(best.norm2);
    double nx = best.nx * unit, ny = best.ny * unit;
    if (nx * px + ny * py > 0.0) {
      nx = -nx;
      ny = -ny;
    }
    const double off = nx * (px - best.cx) + ny * (py - best.cy);
    if (off * off > 9.0 * std::max(expected, best.residual)) continue;
    const double cosine = std::clamp(-(nx * px + ny * py) / r, 0.0, 1.0);
    const double across = std::max(cosine, kLeastCosine) * sigma;
    point.nx = static_cast<float>(nx);
    point.ny = static_cast<float>(ny);
    point.line_x = static_cast<float>(px - off * nx);
    point.line_y = static_cast<float>(py - off * ny);
    point.length = static_cast<float>(step / std::max(cosine, 0.2));
    point.variance = static_cast<float>(across * across);
    out.normal_variance[i] =
        static_cast<float>(std::min(std::max(across * across, best.residual) / (best.count * best.spread), 0.3));
  }
}

}  // namespace

void sort_beams(const Scan& scan, SurfaceWorkspace& work) {
  const std::size_t n = scan.size();
  work.angle.resize(n);
  work.order.resize(n);
  if (scan.angles.empty()) {
    const bool forward = scan.geometry.angle_increment >= 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t beam = forward ? i : n - 1 - i;
      work.order[i] = static_cast<int>(beam);
      work.angle[i] = scan.angle(beam);
    }
    return;
  }
  std::iota(work.order.begin(), work.order.end(), 0);
  std::stable_sort(work.order.begin(), work.order.end(), [&](int a, int b) { return scan.angles[a] < scan.angles[b]; });
  for (std::size_t i = 0; i < n; ++i) work.angle[i] = scan.angle(static_cast<std::size_t>(work.order[i]));
}

void find_surface(const Scan& scan, const Twist2& twist, SurfaceWorkspace& work, SurfacePoints& out) {
  out.points.clear();
  out.range.clear();
  out.beam.clear();
  sort_beams(scan, work);
  directions(scan, work);
  const std::size_t beams = scan.size();
  out.spacing = beams > 1 ? (work.angle.back() - work.angle.front()) / static_cast<double>(beams - 1) : 0.0;
  take_points(scan, twist, work, out);
  const std::size_t n = out.size();
  out.sigma.resize(n);
  out.normal_variance.resize(n);
  out.extent = 0.0;
  if (n > 0) {
    work.scratch.assign(out.range.begin(), out.range.end());
    out.extent = static_cast<double>(nth_smallest(work.scratch, (95 * (n - 1)) / 100));
  }
  out.noise = estimate_noise(out, work);
  for (std::size_t i = 0; i < n; ++i) out.sigma[i] = out.noise.sigma(out.range[i]);
  find_segments(out, out.spacing, work);
  find_normals(out.spacing, work, out);
  for (auto& k : out.beam) k = work.order[static_cast<std::size_t>(k)];
}

}  // namespace phasescan
