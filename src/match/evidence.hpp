/// What both scans say of a pose: hits near hits, and no beam through the other's walls.
#pragma once

#include "match/prepared_scan.hpp"

namespace phasescan {

/// How much each kind of evidence counts against one matched hit.
struct EvidenceWeights {
  double violation = 2.0;  ///< a hit where the other scan looked through
  double occluded = 0.6;   ///< a hit behind the other scan's surface
  double empty = 1.0;      ///< a hit where the other scan saw nothing within reach
  double stray = 0.5;      ///< a hit beside a surface, or one that faces another way
};

/// Counts of hits by what the other scan says of them, both ways together.
struct PoseEvidence {
  double matched = 0.0;  ///< each hit counts by how near it is, 0..1
  double violation = 0.0;
  double occluded = 0.0;
  double empty = 0.0;
  double stray = 0.0;
  double silent = 0.0;  ///< outside the other scan's view
  int hits = 0;

  double score(const EvidenceWeights& w) const {
    if (hits == 0) return 0.0;
    return (matched - w.violation * violation - w.occluded * occluded - w.empty * empty - w.stray * stray) / hits;
  }
};

/// Evidence of the given hits of both scans at T_ref_scan. The tolerance follows noise, cells and `slack_m`.
/// @cost a few ns a hit
PoseEvidence weigh_evidence(const PreparedScan& reference, const PreparedScan& scan, const SurfaceBatch& reference_hits,
                            const SurfaceBatch& scan_hits, const Pose2& T_ref_scan, double slack_m);

}  // namespace phasescan
