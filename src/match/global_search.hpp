/// The search of the global matcher: hypotheses from a coarse sweep, refined, weighed by evidence, the best ones
/// refined fully.
///
///  1. For every rotation (RotationHypotheses) the scan's sparse hits are correlated with the reference's score table;
///  each
///     rotation offers its two best translations.
///  2. The best of them, without near duplicates, are refined with the sparse hits and weighed by evidence.
///  3. Quarter and half turns of the best, also outside the window: the twins of symmetric rooms.
///  4. A few finalists are refined and weighed with more hits, both ways. Of twins that tie the one that turned less
///     comes first.
///  5. The best is refined with all hits; a place a little way along its weakest direction is tried too.
///
/// The number of operations is bounded by the options; nothing depends on a clock.
#pragma once

#include <optional>
#include <vector>

#include "match/evidence.hpp"
#include "match/prepared_scan.hpp"
#include "match/rotation_hypotheses.hpp"
#include "match/sparse_correlation.hpp"
#include "match/stage_clock.hpp"
#include "phasescan/match/options.hpp"
#include "phasescan/match/result.hpp"

namespace phasescan {

/// A pose under consideration.
struct Hypothesis {
  Pose2 T_ref_scan;
  int coarse = 0;      ///< sum of the coarse table
  double score = 0.0;  ///< by evidence, per hit
  RotationSource source = RotationSource::kSweep;
};

/// A profile below it: along its weakest direction the pose is as good a little farther on.
inline constexpr double kFlatProfile = 0.01;

/// What the search found, best first, and what speaks for it.
struct SearchOutcome {
  std::vector<Hypothesis> hypotheses;  ///< distinct poses
  PointToLineResult refined;           ///< of the best
  Eigen::Matrix3d residual_covariance =
      Eigen::Matrix3d::Zero();  ///< of the best, see covariance_of_residuals; zero: not known
  double reference_turn_variance = 0.0, scan_turn_variance = 0.0;  ///< of the revolutions as a whole [rad^2]
  PoseEvidence evidence;                                           ///< of the best
  double margin =
      0.0;  ///< score of the best less that of the next distinct pose; 2 more than the score if there is none
  double profile = 0.0;  ///< least drop of the score a little way along the weakest direction
};

/// The options of `match.fast`: fewer poses and hits.
GlobalOptions fast_options(const GlobalOptions& options);

/// Owns its buffers; one object per thread.
class GlobalSearch {
 public:
  explicit GlobalSearch(const GlobalOptions& options);

  /// Finds T_ref_scan; with a guess, near it, unless nothing there explains the scans. No hypotheses where the scans
  /// have no hits.
  /// @param proposed  rotations to try without a guess, in place of those of the options; null: as the options say
  void run(const PreparedScan& reference, const PreparedScan& scan, const std::optional<Pose2>& guess,
           const std::vector<RotationHypothesis>* proposed, SearchOutcome& out, MatchTimer* timer = nullptr);

  /// How both scans have to be prepared; the table is needed of the reference only.
  PrepareOptions prepare_options(bool reference) const;

 private:
  void look(const PreparedScan& reference, const PreparedScan& scan, const std::optional<Pose2>& guess, int candidates,
            MatchTimer& timer);
  bool convinces(const PreparedScan& reference, bool guessed) const;
  void sweep(const PreparedScan& reference, const PreparedScan& scan, const std::optional<Pose2>& guess);
  void thin(const PreparedScan& reference, std::size_t most);
  void refine_candidates(const PreparedScan& reference, const PreparedScan& scan);
  void add_twins(const PreparedScan& reference, const PreparedScan& scan);
  void refine_finalists(const PreparedScan& reference, const PreparedScan& scan, SearchOutcome& out);
  void settle(const PreparedScan& reference, const PreparedScan& scan, SearchOutcome& out);
  void refine_quickly(const PreparedScan& reference, const PreparedScan& scan, Hypothesis& hypothesis);
  int correlate(const PreparedScan& reference, const PreparedScan& scan, const Pose2& centre);

  GlobalOptions options_;
  EvidenceWeights weights_;
  RotationHypotheses rotations_;
  std::vector<RotationHypothesis> rotation_list_;
  std::vector<std::int32_t> offsets_;
  std::vector<float> at_u_, at_v_;
  CorrelationWindow window_;
  PointToLineWorkspace refinement_;
  std::vector<NormalEquations> runs_;
  std::vector<Hypothesis> coarse_, kept_, of_guess_;
};

}  // namespace phasescan
