// Nearest surface points for a block of positions; for inclusion into the per-target part of vector code.
//
// What vector code would gather, plain loads copy into blocks: many CPUs gather slowly, and each copy takes two floats.
#if defined(PHASESCAN_REFINE_NEAREST_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PHASESCAN_REFINE_NEAREST_INL
#undef PHASESCAN_REFINE_NEAREST_INL
#else
#define PHASESCAN_REFINE_NEAREST_INL
#endif

#include <hwy/highway.h>

#include <cstring>

#include "refine/nearest_grid.hpp"

HWY_BEFORE_NAMESPACE();
namespace phasescan {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kBlock = 64;  // hits at a time; a multiple of SurfaceBatch::kPadding

// Floats per SurfacePoint.
constexpr std::ptrdiff_t kPointFloats = sizeof(SurfacePoint) / sizeof(float);
static_assert(sizeof(SurfacePoint) == 8 * sizeof(float));

/// Positions, and what is found near them.
struct NearestBlock {
  alignas(64) float qx[kBlock], qy[kBlock];    ///< given
  alignas(64) std::int32_t index[kBlock];      ///< of the nearest point, 0 where none is found
  alignas(64) std::int32_t found[kBlock];      ///< -1 (all bits) or 0
  alignas(64) float distance2[kBlock];         ///< to it
  alignas(64) float neighbour[6][2 * kBlock];  ///< x, y of points around
  alignas(64) std::int32_t centre[kBlock];     ///< around which
};

/// Fields of the nearest points, two by two.
struct PartnerBlock {
  alignas(64) float line[2 * kBlock];     ///< line_x, line_y
  alignas(64) float normal[2 * kBlock];   ///< nx, ny
  alignas(64) float measure[2 * kBlock];  ///< length, variance
};

// x, y of the points at `at` + each of the steps, or of the first or last one where there is none.
template <std::size_t kCount>
HWY_INLINE void CopyNeighbours(const float* points, std::int32_t at, std::int32_t last,
                               const std::int32_t (&steps)[kCount], float (*to)[2 * kBlock], std::size_t j) {
  const float* point = points + at * kPointFloats;
  if (at + steps[0] >= 0 && at + steps[kCount - 1] <= last) {
    for (std::size_t s = 0; s < kCount; ++s)
      std::memcpy(to[s] + 2 * j, point + steps[s] * kPointFloats, 2 * sizeof(float));
    return;
  }
  for (std::size_t s = 0; s < kCount; ++s) {
    const std::int32_t there = at + steps[s] < 0 ? 0 : at + steps[s] > last ? last : at + steps[s];
    std::memcpy(to[s] + 2 * j, points + there * kPointFloats, 2 * sizeof(float));
  }
}

// Takes the nearest of the neighbours where one is nearer than what was found so far; the first of equals.
template <class DF, std::size_t kCount>
HWY_INLINE void TakeNearest(DF df, const std::int32_t (&steps)[kCount], std::int32_t last, std::size_t k,
                            NearestBlock& block) {
  const hn::RebindToSigned<DF> di;
  const auto qx = hn::Load(df, block.qx + k), qy = hn::Load(df, block.qy + k);
  const auto centre = hn::Load(di, block.centre + k);
  auto index = hn::Load(di, block.index + k);
  auto distance2 = hn::Load(df, block.distance2 + k);
  for (std::size_t s = 0; s < kCount; ++s) {
    hn::Vec<DF> x, y;
    hn::LoadInterleaved2(df, block.neighbour[s] + 2 * k, x, y);
    const auto dx = hn::Sub(qx, x), dy = hn::Sub(qy, y);
    const auto d = hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy));
    const auto at = hn::Min(hn::Max(hn::Add(centre, hn::Set(di, steps[s])), hn::Zero(di)), hn::Set(di, last));
    index = hn::IfThenElse(hn::RebindMask(di, hn::Lt(d, distance2)), at, index);
    distance2 = hn::Min(d, distance2);
  }
  hn::Store(index, di, block.index + k);
  hn::Store(distance2, df, block.distance2 + k);
}

// Goes on from the nearest points along the surface, `walks` times, as long as one gets nearer: in wide places many
// points share a cell.
template <class DF>
HWY_INLINE void WalkAlong(DF df, const float* points, std::int32_t last, std::size_t count, int walks,
                          NearestBlock& block) {
  constexpr std::int32_t kSteps[] = {-3, -2, -1, 1, 2, 3};
  for (std::size_t j = 0; j < count; ++j) block.centre[j] = -1;
  for (int walk = 0; walk < walks; ++walk) {
    bool moved = false;
    for (std::size_t j = 0; j < count; ++j) {
      const std::int32_t at = block.index[j];
      if (at == block.centre[j]) continue;
      moved = true;
      block.centre[j] = at;
      CopyNeighbours(points, at, last, kSteps, block.neighbour, j);
    }
    if (!moved) return;
    for (std::size_t k = 0; k < count; k += hn::Lanes(df)) TakeNearest(df, kSteps, last, k, block);
  }
}

// For the first `count` positions of the block (a multiple of the lanes): the nearest of the grid's answer and its two
// neighbours on either side, and from there on along the surface.
template <class DF>
HWY_INLINE void FindNearest(DF df, const NearestGrid::View& grid, const float* points, std::int32_t last,
                            std::size_t count, int walks, NearestBlock& block) {
  const hn::RebindToSigned<DF> di;
  const auto zero = hn::Zero(df), top = hn::Set(df, grid.limit - 1.0F);
  constexpr std::int32_t kSteps[] = {-2, -1, 0, 1, 2};
  const auto offset = hn::Set(df, grid.offset), inverse_cell = hn::Set(df, grid.inverse_cell);
  for (std::size_t k = 0; k < count; k += hn::Lanes(df)) {
    const auto u = hn::Mul(hn::Add(hn::Load(df, block.qx + k), offset), inverse_cell);
    const auto v = hn::Mul(hn::Add(hn::Load(df, block.qy + k), offset), inverse_cell);
    const auto uc = hn::Min(hn::Max(u, zero), top), vc = hn::Min(hn::Max(v, zero), top);
    const auto inside = hn::And(hn::And(hn::Ge(u, zero), hn::Ge(v, zero)), hn::And(hn::Le(u, top), hn::Le(v, top)));
    const auto cell =
        hn::Add(hn::Mul(hn::ConvertTo(di, vc), hn::Set(di, static_cast<int>(grid.stride))), hn::ConvertTo(di, uc));
    hn::Store(cell, di, block.centre + k);
    hn::Store(hn::VecFromMask(di, hn::RebindMask(di, inside)), di, block.found + k);
    hn::Store(hn::Set(df, 1e30F), df, block.distance2 + k);
  }
  for (std::size_t j = 0; j < count; ++j) {
    const auto near = static_cast<std::int32_t>(grid.keys[block.centre[j]] & NearestGrid::kIndexMask) - 1;
    block.found[j] = near < 0 ? 0 : block.found[j];
    block.centre[j] = near;
    block.index[j] = near < 0 ? 0 : near;
    CopyNeighbours(points, near, last, kSteps, block.neighbour, j);
  }
  for (std::size_t k = 0; k < count; k += hn::Lanes(df)) TakeNearest(df, kSteps, last, k, block);
  WalkAlong(df, points, last, count, walks, block);
}

// The fields of the nearest points.
HWY_INLINE void CopyPartners(const float* points, const std::int32_t* index, std::size_t count, PartnerBlock& out) {
  for (std::size_t j = 0; j < count; ++j) {
    const float* point = points + index[j] * kPointFloats;
    std::memcpy(out.line + 2 * j, point + 2, 2 * sizeof(float));
    std::memcpy(out.normal + 2 * j, point + 4, 2 * sizeof(float));
    std::memcpy(out.measure + 2 * j, point + 6, 2 * sizeof(float));
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace phasescan
HWY_AFTER_NAMESPACE();

#endif
