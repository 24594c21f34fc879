#include "scan/surface_lines.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "scan/surface_lines.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

namespace phasescan {
#ifndef PHASESCAN_LINES_TASK
#define PHASESCAN_LINES_TASK
// Lines of all hits, a field an array: centre; normal, not of unit length, and its square; variance along and across;
// hits.
// What a hit gets from its line, field by field.
enum HitField { kHitNx, kHitNy, kHitLineX, kHitLineY, kHitLength, kHitVariance, kHitNormalVariance, kHitFields };
enum LineField { kCentreX, kCentreY, kNormalX, kNormalY, kNorm2, kSpread, kResidual, kCount, kLineFields };

constexpr int kMaxHalfWindow = 48;
constexpr double kLeastCosine = 0.1;         // a beam along a wall is not as good as its noise across it says
constexpr double kLongestCosine = 0.2;       // nor does it stand for as much of the wall
constexpr double kMostNormalVariance = 0.3;  // [rad^2] nothing is known of the direction
// A line is fitted this far to either side, short enough for furniture, and farther where the wall runs on.
constexpr double kReachShare = 0.007, kReachSigmas = 1.0;  // of the extent; of the range noise
constexpr double kLeastStep = 1e-4;                        // [m] between hits
constexpr int kLonger = 4;
constexpr double kStraight = 1.0;  // of the expected variance across the line: a longer line must fit this well
// A beam along the line (less than about 12 deg apart) is given no more credit.
constexpr double kLeastCosine2 = 0.04;

struct LinesTask {
  const double* sums;               // before each hit: x, y, xx, xy, yy
  const double *x, *y;              // hits [m]
  const float *range, *sigma;       // [m]
  const std::int32_t *begin, *end;  // the segment
  std::size_t count;                // padded to whole vectors
  double spacing, least_reach;      // between beams [rad]; of a window [m]
  std::int32_t* half;               // half a window
  double* lines;                    // kLineFields arrays of `count`
  float* hits;                      // kHitFields arrays of `count`
  std::uint8_t* found;              // 1 where a long window has a line
};
#endif
}  // namespace phasescan

HWY_BEFORE_NAMESPACE();
namespace phasescan {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr hn::CappedTag<double, 8> kD;
constexpr hn::RebindToSigned<decltype(kD)> kI;
using V = hn::Vec<decltype(kD)>;
using I = hn::Vec<decltype(kI)>;
using M = hn::Mask<decltype(kD)>;

struct Fit {
  V field[kLineFields];
};

HWY_INLINE Fit FitLines(const double* sums, I from, I to) {
  const I a = hn::Add(hn::ShiftLeft<2>(from), from), b = hn::Add(hn::ShiftLeft<2>(to), to);
  const V count = hn::ConvertTo(kD, hn::Sub(to, from)), inv = hn::Div(hn::Set(kD, 1.0), count), half = hn::Set(kD, 0.5);
  const auto mean_of = [&](int k) {
    return hn::Mul(hn::Sub(hn::GatherIndex(kD, sums + k, b), hn::GatherIndex(kD, sums + k, a)), inv);
  };
  const V cx = mean_of(0), cy = mean_of(1);
  const V xx = hn::Sub(mean_of(2), hn::Mul(cx, cx)), xy = hn::Sub(mean_of(3), hn::Mul(cx, cy)),
          yy = hn::Sub(mean_of(4), hn::Mul(cy, cy));
  const V lead = hn::Mul(half, hn::Sub(xx, yy)), mean = hn::Mul(half, hn::Add(xx, yy));
  const V root = hn::Sqrt(hn::Add(hn::Mul(lead, lead), hn::Mul(xy, xy)));
  // Eigenvector of the small eigenvalue, from the better conditioned row.
  const M flat = hn::Ge(lead, hn::Zero(kD));
  const V nx = hn::IfThenElse(flat, xy, hn::Sub(root, lead));
  const V ny = hn::Neg(hn::IfThenElse(flat, hn::Add(lead, root), xy));
  return {{cx, cy, nx, ny, hn::Add(hn::Mul(nx, nx), hn::Mul(ny, ny)), hn::Add(mean, root),
           hn::Max(hn::Sub(mean, root), hn::Zero(kD)), count}};
}

HWY_INLINE M Fits(const Fit& fit, V variance, V px, V py) {
  const V dot = hn::Add(hn::Mul(fit.field[kNormalX], px), hn::Mul(fit.field[kNormalY], py));
  const V all = hn::Mul(fit.field[kNorm2], hn::Add(hn::Mul(px, px), hn::Mul(py, py)));
  return hn::Le(hn::Mul(fit.field[kResidual], all),
                hn::Mul(variance, hn::Max(hn::Mul(dot, dot), hn::Mul(hn::Set(kD, kLeastCosine2), all))));
}

// Half windows, and the two longest windows, which serve most hits on walls.
void FitLongLines(const LinesTask& task) {
  const hn::Rebind<std::int32_t, decltype(kD)> d32;
  const hn::Rebind<float, decltype(kD)> df;
  const I one = hn::Set(kI, 1);
  I at = hn::Iota(kI, 0);
  alignas(64) std::int64_t is_found[hn::MaxLanes(kD)];
  for (std::size_t k = 0; k < task.count; k += hn::Lanes(kD)) {
    const V px = hn::LoadU(kD, task.x + k), py = hn::LoadU(kD, task.y + k);
    const V range = hn::PromoteTo(kD, hn::LoadU(df, task.range + k)),
            sigma = hn::PromoteTo(kD, hn::LoadU(df, task.sigma + k));
    const V step = hn::Max(hn::Mul(hn::Set(kD, task.spacing), range), hn::Set(kD, kLeastStep));
    const V reach = hn::Max(hn::Set(kD, task.least_reach), hn::Mul(hn::Set(kD, kReachSigmas), sigma));
    const auto short_half = hn::DemoteTo(
        d32, hn::Min(hn::Max(hn::Ceil(hn::Div(reach, step)), hn::Set(kD, 2.0)), hn::Set(kD, double{kMaxHalfWindow})));
    hn::StoreU(short_half, d32, task.half + k);
    const V variance = hn::Mul(hn::Set(kD, kStraight), hn::Mul(sigma, sigma));
    const I begin = hn::PromoteTo(kI, hn::LoadU(d32, task.begin + k)),
            end = hn::PromoteTo(kI, hn::LoadU(d32, task.end + k));
    I half = hn::PromoteTo(kI, short_half);
    const auto fit_longer = [&] {
      static_assert(kLonger == 4);
      half = hn::ShiftLeft<2>(half);
      return FitLines(task.sums, hn::Max(begin, hn::Sub(at, half)), hn::Min(end, hn::Add(hn::Add(at, half), one)));
    };
    Fit best = fit_longer();
    const M found = hn::And(Fits(best, variance, px, py), hn::Ge(best.field[kCount], hn::Set(kD, 3.0)));
    if (!hn::AllFalse(kD, found)) {
      const Fit longest = fit_longer();
      const M better = Fits(longest, variance, px, py);
      for (int f = 0; f < kLineFields; ++f) best.field[f] = hn::IfThenElse(better, longest.field[f], best.field[f]);
    }
    for (int f = 0; f < kLineFields; ++f)
      hn::StoreU(best.field[f], kD, task.lines + static_cast<std::size_t>(f) * task.count + k);
    hn::Store(hn::IfThenElseZero(hn::RebindMask(kI, found), one), kI, is_found);
    for (std::size_t lane = 0; lane < hn::Lanes(kD); ++lane)
      task.found[k + lane] = static_cast<std::uint8_t>(is_found[lane]);
    at = hn::Add(at, hn::Set(kI, static_cast<std::int64_t>(hn::Lanes(kD))));
  }
}

// From lines to what the hits get.
void FinishHits(const LinesTask& task) {
  const hn::Rebind<std::int32_t, decltype(kD)> d32;
  const hn::Rebind<float, decltype(kD)> df;
  const V zero = hn::Zero(kD), one = hn::Set(kD, 1.0);
  for (std::size_t k = 0; k < task.count; k += hn::Lanes(kD)) {
    const auto line = [&](LineField f) {
      return hn::LoadU(kD, task.lines + static_cast<std::size_t>(f) * task.count + k);
    };
    const V px = hn::LoadU(kD, task.x + k), py = hn::LoadU(kD, task.y + k);
    const V range = hn::PromoteTo(kD, hn::LoadU(df, task.range + k)),
            sigma = hn::PromoteTo(kD, hn::LoadU(df, task.sigma + k));
    const V step = hn::Max(hn::Mul(hn::Set(kD, task.spacing), range), hn::Set(kD, kLeastStep));
    const V expected = hn::Mul(sigma, sigma), residual = line(kResidual), spread = line(kSpread), count = line(kCount);
    const V unit = hn::Div(one, hn::Sqrt(line(kNorm2)));
    V nx = hn::Mul(line(kNormalX), unit), ny = hn::Mul(line(kNormalY), unit);
    const M away = hn::Gt(hn::Add(hn::Mul(nx, px), hn::Mul(ny, py)), zero);
    nx = hn::IfThenElse(away, hn::Neg(nx), nx);
    ny = hn::IfThenElse(away, hn::Neg(ny), ny);
    const V off = hn::Add(hn::Mul(nx, hn::Sub(px, line(kCentreX))), hn::Mul(ny, hn::Sub(py, line(kCentreY))));
    const I size = hn::PromoteTo(kI, hn::Sub(hn::LoadU(d32, task.end + k), hn::LoadU(d32, task.begin + k)));
    M good = hn::RebindMask(kD, hn::Gt(size, hn::Set(kI, 2)));
    good = hn::And(good, hn::Ge(count, hn::Set(kD, 3.0)));
    good = hn::And(good, hn::And(hn::Ge(spread, hn::Mul(hn::Set(kD, 4.0), residual)), hn::Gt(spread, zero)));
    good = hn::And(good, hn::Le(hn::Mul(off, off), hn::Mul(hn::Set(kD, 9.0), hn::Max(expected, residual))));
    const V towards = hn::Neg(hn::Div(hn::Add(hn::Mul(nx, px), hn::Mul(ny, py)), range));
    const V cosine = hn::Min(hn::Max(towards, zero), one);
    const V across = hn::Mul(hn::Max(cosine, hn::Set(kD, kLeastCosine)), sigma), across2 = hn::Mul(across, across);
    const V turn =
        hn::Min(hn::Div(hn::Max(across2, residual), hn::Mul(count, spread)), hn::Set(kD, kMostNormalVariance));
    const auto put = [&](HitField f, V value, V otherwise) {
      hn::StoreU(hn::DemoteTo(df, hn::IfThenElse(good, value, otherwise)), df,
                 task.hits + static_cast<std::size_t>(f) * task.count + k);
    };
    put(kHitNx, nx, zero);
    put(kHitNy, ny, zero);
    put(kHitLineX, hn::Sub(px, hn::Mul(off, nx)), px);
    put(kHitLineY, hn::Sub(py, hn::Mul(off, ny)), py);
    put(kHitLength, hn::Div(step, hn::Max(cosine, hn::Set(kD, kLongestCosine))), hn::Add(step, step));
    put(kHitVariance, across2, hn::Mul(hn::Set(kD, 0.25), expected));
    put(kHitNormalVariance, turn, hn::Set(kD, kMostNormalVariance));
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace phasescan
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <algorithm>
#include <cmath>

namespace phasescan {
HWY_EXPORT(FitLongLines);
HWY_EXPORT(FinishHits);

namespace {

constexpr std::size_t kPadding = 8;

struct LineFit {
  double cx = 0, cy = 0, nx = 0, ny = 0, norm2 = 0;  // centre; normal, not of unit length, and its square
  double spread = 0, residual = 0;                   // variance along and across the line
  int count = 0;

  // Whether the line fits as well as `variance` of the ranges lets expect at (px, py).
  bool fits(double variance, double px, double py) const {
    const double dot = nx * px + ny * py, all = norm2 * (px * px + py * py);
    return residual * all <= variance * std::max(dot * dot, kLeastCosine2 * all);
  }
};

// As FitLines, for one hit.
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
LineFit fit_short_line(const SurfaceWorkspace& work, std::size_t hit, double expected) {
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
  return best.count >= 3 && longer.fits(kStraight * expected, px, py) ? longer : best;
}

}  // namespace

void find_lines(SurfaceWorkspace& work, SurfacePoints& out) {
  const std::size_t n = out.size(), padded = (n + kPadding - 1) / kPadding * kPadding;
  sum_up(out, padded, work);
  for (auto* v : {&work.segment_begin, &work.segment_end}) v->resize(padded, 0);
  for (auto* v : {&out.range, &out.sigma}) v->resize(padded, 1.0F);
  work.half.resize(padded);
  work.lines.resize(kLineFields * padded);
  work.found.resize(padded);
  work.hits.resize(kHitFields * padded);
  const LinesTask task{
      work.sums.data(),          work.x.data(),           work.y.data(),    out.range.data(), out.sigma.data(),
      work.segment_begin.data(), work.segment_end.data(), padded,           out.spacing,      kReachShare * out.extent,
      work.half.data(),          work.lines.data(),       work.hits.data(), work.found.data()};
  HWY_DYNAMIC_DISPATCH(FitLongLines)(task);
  for (std::size_t i = 0; i < n; ++i) {
    if (work.found[i] != 0 || work.segment_end[i] - work.segment_begin[i] < 3) continue;
    const double sigma = static_cast<double>(out.sigma[i]);
    const LineFit line = fit_short_line(work, i, sigma * sigma);
    double* field = work.lines.data() + i;
    for (const double value :
         {line.cx, line.cy, line.nx, line.ny, line.norm2, line.spread, line.residual, double(line.count)}) {
      *field = value;
      field += padded;
    }
  }
  HWY_DYNAMIC_DISPATCH(FinishHits)(task);
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
#endif
