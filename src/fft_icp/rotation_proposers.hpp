/// The rotations of [Jiang19] for the global matcher's search: what each of the two sources is worth there.
#pragma once

#include <memory>

#include "match/rotation_proposer.hpp"

namespace phasescan {

/// Peaks of the correlation of two image spectra, each with the rotation half a turn away.
std::unique_ptr<RotationProposer> propose_from_spectrum(int peaks);

/// The rotation that the missing data tell, if they are sure, and one `half_step_rad` to either side of it.
std::unique_ptr<RotationProposer> propose_from_missing(double half_step_rad);

}  // namespace phasescan
