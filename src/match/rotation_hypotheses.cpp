#include "match/rotation_hypotheses.hpp"

#include <algorithm>
#include <cmath>

#include "match/from_normals.hpp"

namespace phasescan {

void RotationHypotheses::all(double centre, int steps_each_side, std::vector<RotationHypothesis>& out) const {
  const int steps = std::max(1, static_cast<int>(std::lround(360.0 / options_.sweep_step_deg)));
  const bool whole_turn = 2 * steps_each_side + 1 >= steps;
  const int from = whole_turn ? 0 : -steps_each_side, to = whole_turn ? steps - 1 : steps_each_side;
  for (int k = from; k <= to; ++k) out.push_back({wrap_angle(centre + kTwoPi * k / steps), RotationSource::kSweep});
}

void RotationHypotheses::list_all(std::vector<RotationHypothesis>& out) const {
  out.clear();
  all(0.0, 1 << 20, out);
}

void RotationHypotheses::list(const PreparedScan& reference, const PreparedScan& scan,
                              const std::optional<Pose2>& guess, const std::vector<RotationHypothesis>* proposed,
                              std::vector<RotationHypothesis>& out) {
  out.clear();
  if (guess) {
    all(guess->theta, static_cast<int>(std::ceil(options_.guess_turn_deg / options_.sweep_step_deg)), out);
    for (RotationHypothesis& hypothesis : out) hypothesis.source = RotationSource::kGuess;
    return;
  }
  if (proposed != nullptr) {
    out.assign(proposed->begin(), proposed->end());
  } else if (options_.rotations != RotationSearch::kSweep) {
    NormalCorrelation correlation;
    correlate_normals(reference.normals, scan.normals, correlation);
    normal_peaks(correlation, options_.rotation_peaks, angles_);
    for (const double theta : angles_) out.push_back({theta, RotationSource::kNormals});
  }
  // The complete sweep: where asked for, and where a source has nothing to say.
  if (out.empty()) all(0.0, 1 << 20, out);
}

}  // namespace phasescan
