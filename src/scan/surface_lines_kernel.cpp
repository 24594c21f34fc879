#include "scan/surface_lines_kernel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "scan/surface_lines_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace phasescan::surface_lines {
namespace HWY_NAMESPACE {

constexpr int kMaxHalfWindow = 48;
constexpr double kLeastCosine = 0.1;         // a beam along a wall is not as good as its noise across it says
constexpr double kLongestCosine = 0.2;       // nor does it stand for as much of the wall
constexpr double kMostNormalVariance = 0.3;  // [rad^2] nothing is known of the direction
constexpr double kReachSigmas = 1.0;         // a short line reaches at least so far to either side, of the range noise
constexpr double kLeastStep = 1e-4;          // [m] between hits

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
    const V variance = hn::Mul(hn::Set(kD, task.straightness), hn::Mul(sigma, sigma));
    const I begin = hn::PromoteTo(kI, hn::LoadU(d32, task.begin + k)),
            end = hn::PromoteTo(kI, hn::LoadU(d32, task.end + k));
    I half = hn::PromoteTo(kI, short_half);
    const auto fit_longer = [&] {
      half = hn::ShiftLeft<2>(half);  // four times as long
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
    const V scatter = hn::Mul(expected, hn::Sub(one, hn::Mul(cosine, cosine)));
    good = hn::And(good, hn::Ge(spread, hn::Mul(hn::Set(kD, task.least_spread), scatter)));
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
}  // namespace phasescan::surface_lines
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace phasescan::surface_lines {
HWY_EXPORT(FitLongLines);
HWY_EXPORT(FinishHits);

void fit_long_lines(const LinesTask& task) {
  HWY_DYNAMIC_DISPATCH(FitLongLines)(task);
}

void finish_hits(const LinesTask& task) {
  HWY_DYNAMIC_DISPATCH(FinishHits)(task);
}

}  // namespace phasescan::surface_lines
#endif
