/// Scans at even angles, which is all that LaserScan messages and CARMEN lines can say.
#pragma once

#include "phasescan/scan/scan.hpp"

namespace phasescan {

/// The scan with its beams moved to the nearest of even angles; where two meet the nearer one stays. The same scan
/// where its angles are even already. `largest_move_rad` tells how far a beam was moved.
Scan even_scan(const Scan& scan, double* largest_move_rad = nullptr);

}  // namespace phasescan
