/// fft-mh's search: hypotheses from a coarse sweep, refined, weighed by evidence, the best ones refined fully.
#pragma once

#include <optional>
#include <vector>

#include "phasescan/match/evidence.hpp"
#include "phasescan/match/mh_options.hpp"
#include "phasescan/match/prepared_scan.hpp"
#include "phasescan/match/result.hpp"
#include "phasescan/translation/sparse_correlation.hpp"

namespace phasescan {

/// A pose under consideration.
struct Hypothesis {
  Pose2 T_ref_scan;
  int coarse = 0;          ///< sum of the coarse table
  double score = 0.0;      ///< by evidence, per hit
  RotationSource source = RotationSource::kSweep;
};

/// What the search found, best first, and what speaks for it.
struct SearchOutcome {
  std::vector<Hypothesis> hypotheses;   ///< distinct poses
  PointToLineResult refined;            ///< of the best
  Evidence evidence;                    ///< of the best, all hits that are weighed
  double margin = 0.0;                  ///< score of the best less that of the next distinct pose
  double profile = 0.0;                 ///< how much the score drops a little way along the weakest direction
};

/// Owns its buffers; one object per thread.
class MultiHypothesisSearch {
 public:
  explicit MultiHypothesisSearch(const MhOptions& options) : options_(options) {}

  void run(const PreparedScan& reference, const PreparedScan& scan, const std::optional<Pose2>& guess, SearchOutcome& out);

 private:
  void sweep(const PreparedScan& reference, const PreparedScan& scan, const Pose2& centre);
  void add_twins(const PreparedScan& reference, const PreparedScan& scan, double theta);
  /// Correlates at one rotation about a centre; false where no point falls onto the table.
  int correlate(const PreparedScan& reference, const PreparedScan& scan, const Pose2& centre);
  void thin(const PreparedScan& reference);

  MhOptions options_;
  std::vector<std::int32_t> offsets_;
  CorrelationWindow window_;
  std::vector<Hypothesis> coarse_, kept_;
};

}  // namespace phasescan
