#include "scan/directions.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "scan/directions.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/directions-inl.hpp"
#include "scan/surface.hpp"

HWY_BEFORE_NAMESPACE();
namespace phasescan {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void FillDirections(const float* x, const float* y, std::size_t count, float* out) {
  const hn::CappedTag<float, SurfaceBatch::kPadding> df;
  for (std::size_t k = 0; k < count; k += hn::Lanes(df))
    hn::StoreU(DirectionTurns(df, hn::LoadU(df, x + k), hn::LoadU(df, y + k)), df, out + k);
}

}  // namespace HWY_NAMESPACE
}  // namespace phasescan
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace phasescan {
HWY_EXPORT(FillDirections);

void fill_directions(const float* x, const float* y, std::size_t count, float* out) {
  HWY_DYNAMIC_DISPATCH(FillDirections)(x, y, count, out);
}

}  // namespace phasescan
#endif
