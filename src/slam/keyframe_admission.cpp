#include "slam/keyframe_admission.hpp"

#include "slam/bounded_admission.hpp"

namespace phasescan {

std::unique_ptr<KeyframeAdmission> make_admission(const SlamOptions& options, AdmissionState state) {
  if (options.slam.bounded_memory) return std::make_unique<BoundedAdmission>(options, std::move(state));
  return std::make_unique<AppendAdmission>();
}

void AppendAdmission::submit(Keyframe keyframe, const GraphSession&, PlaceSearch&) {
  submitted_ = std::move(keyframe);
}

std::optional<Placement> AppendAdmission::next(const GraphSession&) {
  if (!submitted_) return std::nullopt;
  Placement placement{std::move(*submitted_), std::nullopt};
  submitted_.reset();
  return placement;
}

}  // namespace phasescan
