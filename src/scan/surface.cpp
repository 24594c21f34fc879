#include "scan/surface.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>

#include "scan/surface_lines.hpp"

namespace phasescan {
namespace {

constexpr int kBeamsPerRestart = 64;  // the rotation recurrence is restarted so often: error below 1e-13
constexpr double kReliefM = 0.01;     // [m] of walls: a noise of so much begins to hide it
constexpr double kMinFloor = 0.004;   // [m] no lidar of this kind is better than this

// Order statistics of values that are not negative. A count by leading bits finds the few values that are worth a sort.
class Ranks {
 public:
  explicit Ranks(std::span<const float> values) : values_(values) {
    for (const float value : values) ++counts_[bucket_of(value)];
  }

  // The nth smallest. @param scratch  loses what it held
  float nth_smallest(std::size_t nth, std::vector<float>& scratch) const {
    std::size_t bucket = 0;
    for (; nth >= counts_[bucket]; ++bucket) nth -= counts_[bucket];
    scratch.resize(values_.size());
    std::size_t kept = 0;
    for (const float value : values_) {
      scratch[kept] = value;
      kept += bucket_of(value) == bucket;
    }
    const auto at = scratch.begin() + static_cast<std::ptrdiff_t>(nth);
    std::nth_element(scratch.begin(), at, scratch.begin() + static_cast<std::ptrdiff_t>(kept));
    return *at;
  }

 private:
  static constexpr int kShift = 20, kFirst = 110 << 3, kBuckets = 256;  // eighths of octaves from 8e-6 to 3e4
  static std::size_t bucket_of(float value) {
    return static_cast<std::size_t>(
        std::clamp(static_cast<int>(std::bit_cast<std::uint32_t>(value) >> kShift) - kFirst, 0, kBuckets - 1));
  }

  std::span<const float> values_;
  std::array<std::uint32_t, kBuckets> counts_{};
};

double median_of(std::span<const float> values, std::vector<float>& scratch) {
  return values.empty() ? 0.0 : static_cast<double>(Ranks(values).nth_smallest(values.size() / 2, scratch));
}

// Beams in order of direction, counter-clockwise: `order` holds beam indices, `angle` their directions [rad].
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

// Order, angle, cosine and sine of the beams; those at hand where the last scan lay alike.
void find_directions(const Scan& scan, SurfaceWorkspace& work) {
  const ScanGeometry& geometry = scan.geometry;
  if (work.directions_known && scan.angles.empty() && work.order.size() == scan.size() &&
      work.angle_min == geometry.angle_min && work.angle_increment == geometry.angle_increment)
    return;
  sort_beams(scan, work);
  directions(scan, work);
  work.angle_min = geometry.angle_min;
  work.angle_increment = geometry.angle_increment;
  work.directions_known = scan.angles.empty();
}

void take_points(const Scan& scan, const Twist2& twist, const SurfaceWorkspace& work, SurfacePoints& out) {
  const bool deskew = !twist.is_zero() && scan.time_increment != 0.0;
  out.points.resize(work.order.size());
  out.range.resize(work.order.size());
  out.beam.resize(work.order.size());
  std::size_t n = 0;
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
    SurfacePoint& point = out.points[n];
    point.x = point.line_x = static_cast<float>(px);
    point.y = point.line_y = static_cast<float>(py);
    out.range[n] = r;
    out.beam[n] = static_cast<int>(k);  // position in `order` for now: neighbours in direction
    ++n;
  }
  out.points.resize(n);
  out.range.resize(n);
  out.beam.resize(n);
}

// Beams from one hit to the next, as a rule. More than one where a converter spread a sensor's hits over more beams
// than it has: what it has between them is no missing return.
int usual_step(const SurfacePoints& points, std::size_t beams, SurfaceWorkspace& work) {
  const std::size_t n = points.size();
  if (n < 3 || 2 * n >= beams) return 1;
  work.scratch.resize(n - 1);
  for (std::size_t i = 0; i + 1 < n; ++i) work.scratch[i] = static_cast<float>(points.beam[i + 1] - points.beam[i]);
  const auto middle = work.scratch.begin() + static_cast<std::ptrdiff_t>(work.scratch.size() / 2);
  std::nth_element(work.scratch.begin(), middle, work.scratch.end());
  return static_cast<int>(*middle);
}

// How far a range is off the line between its neighbours', as a second difference of ranges that lie evenly.
float second_difference(const SurfacePoints& points, std::size_t i) {
  const auto back = static_cast<float>(points.beam[i] - points.beam[i - 1]),
             on = static_cast<float>(points.beam[i + 1] - points.beam[i]);
  const float before = on / (back + on), after = back / (back + on);
  const float off = before * points.range[i - 1] - points.range[i] + after * points.range[i + 1];
  return std::fabs(off) * std::sqrt(6.0F / (1.0F + before * before + after * after));
}

// Range noise from second differences along runs of adjacent beams, near and far halves apart.
RangeNoise estimate_noise(const SurfacePoints& points, int usual, SurfaceWorkspace& work) {
  RangeNoise noise{0.01F, 0.01F};
  const std::size_t n = points.size();
  const auto in_run = [&](std::size_t i) {
    const int step = points.beam[i + 1] - points.beam[i - 1];
    return usual == 1 ? step == 2 : step <= 3 * usual;
  };
  work.near.resize(n);
  std::size_t count = 0;
  for (std::size_t i = 1; i + 1 < n; ++i) {
    work.near[count] = points.range[i];
    count += in_run(i);
  }
  if (count < 16) return noise;
  work.near.resize(count);
  const Ranks ranges(work.near);
  const float split = ranges.nth_smallest(count / 2, work.scratch);
  // The near half: up to the median, and what equals it.
  std::size_t of_half[2] = {0, 0};
  for (const float range : work.near) ++of_half[range > split];
  const double range[2] = {
      static_cast<double>(ranges.nth_smallest(of_half[0] / 2, work.scratch)),
      of_half[1] > 0 ? static_cast<double>(ranges.nth_smallest(of_half[0] + of_half[1] / 2, work.scratch)) : 0.0};
  work.near.resize(n);
  work.far.resize(n);
  std::size_t near = 0, far = 0;
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const float difference = usual == 1 ? std::fabs(points.range[i - 1] - 2.0F * points.range[i] + points.range[i + 1])
                                        : second_difference(points, i);
    work.near[near] = work.far[far] = difference;
    const bool counts = in_run(i), is_far = points.range[i] > split;
    near += counts && !is_far;
    far += counts && is_far;
  }
  constexpr double kToSigma = 1.0 / (0.6745 * 2.4495);  // median |r0 - 2 r1 + r2| of unit noise is 0.6745 sqrt(6)
  const double sigma[2] = {kToSigma * median_of(std::span(work.near).first(near), work.scratch),
                           kToSigma * median_of(std::span(work.far).first(far), work.scratch)};
  const double most = std::max(0.06, 0.05 * range[0]);
  noise.floor_m = static_cast<float>(std::clamp(sigma[0], std::min(std::max(kMinFloor, 0.25 * sigma[1]), most), most));
  const double far_rate = range[1] > 0.0 ? sigma[1] / range[1] : 0.01;
  noise.per_metre = static_cast<float>(std::clamp(far_rate, 0.001, 0.03));
  return noise;
}

// Which hits lie on one surface: a run ends where beams are missing or the surface jumps.
void find_segments(const SurfacePoints& points, double spacing, int usual, SurfaceWorkspace& work) {
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
      breaks = gap > 4 * usual || dx * dx + dy * dy > limit * limit;
    }
    if (breaks) {
      for (int k = begin; k <= i; ++k) work.segment_end[k] = i + 1;
      begin = i + 1;
    }
  }
}

}  // namespace

void find_surface(const Scan& scan, const Twist2& twist, SurfaceWorkspace& work, SurfacePoints& out,
                  const WallLines& lines) {
  find_directions(scan, work);
  const std::size_t beams = scan.size();
  out.spacing = beams > 1 ? (work.angle.back() - work.angle.front()) / static_cast<double>(beams - 1) : 0.0;
  take_points(scan, twist, work, out);
  const std::size_t n = out.size();
  out.sigma.resize(n);
  out.normal_variance.resize(n);
  out.extent = 0.0;
  if (n > 0) {
    out.extent = static_cast<double>(Ranks(out.range).nth_smallest((95 * (n - 1)) / 100, work.scratch));
  }
  const int usual = usual_step(out, beams, work);
  out.noise = estimate_noise(out, usual, work);
  for (std::size_t i = 0; i < n; ++i) out.sigma[i] = out.noise.sigma(out.range[i]);
  find_segments(out, out.spacing, usual, work);
  out.spacing *= usual;
  const double noisy = std::clamp((static_cast<double>(out.noise.floor_m) - kReliefM) / kReliefM, 0.0, 1.0);
  find_lines(lines.straightness + noisy * (lines.noisy_straightness - lines.straightness), lines.least_spread, work,
             out);
  for (auto& k : out.beam) k = work.order[static_cast<std::size_t>(k)];
}

}  // namespace phasescan
