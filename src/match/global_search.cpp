#include "match/global_search.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "match/hypothesis_list.hpp"
#include "match/stage_clock.hpp"

namespace phasescan {
namespace {

constexpr int kWindow = CorrelationWindow::kWindow;
constexpr int kPeakCells = 3;        // a second translation of one rotation is farther than this from the first
constexpr double kTwinShare = 0.85;  // of the best coarse sum: worth a closer look
constexpr int kSettleAttempts = 2;   // slides along the weakest direction that are followed
constexpr int kMoreInDoubt = 2;      // times the candidates when the first look does not convince
constexpr double kSureScore = 0.25, kSureMargin = 0.15;       // below either a few rotations are not enough
constexpr double kSlideSteps[] = {-0.05, -0.02, 0.02, 0.05};  // [share of the scale] along the weakest direction
constexpr double kWorthASlide = 0.01;                         // by so much the score must be better there
constexpr double kDoubtfulProfile = 0.1;                      // below it all hits are asked
// Lengths as shares of the scale (about 6 m for an RPLidar A1), from the coarse cell down.
constexpr double kQuickGateStart = 0.075, kMiddleGateStart = 0.05, kFineGateStart = 0.033, kGateEnd = 0.02;
constexpr double kQuickSlack = 0.01, kFineSlack = 0.0015;
constexpr double kTieMargin = 0.03, kSlidingTieMargin = 0.12;

// The pose at a peak of the window around `centre`.
Pose2 shifted(const Pose2& centre, const ScoreTable& table, const CorrelationPeak& peak) {
  const auto cell = static_cast<double>(table.cell());
  return {centre.x + cell * (peak.column - kWindow / 2), centre.y + cell * (peak.row - kWindow / 2), centre.theta};
}

Pose2 slid(const Pose2& pose, const Eigen::Vector2d& by) {
  return {pose.x + by.x(), pose.y + by.y(), pose.theta};
}

Eigen::Vector2d weakest_direction(const Eigen::Matrix3d& information) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen;
  eigen.computeDirect(Eigen::Matrix2d(information.topLeftCorner<2, 2>()));
  return eigen.eigenvectors().col(0);
}

}  // namespace

GlobalOptions fast_options(const GlobalOptions& options) {
  GlobalOptions fast = options;
  fast.sparse_points = 48;
  fast.middle_points = 96;
  fast.candidates = 4;
  fast.finalists = 2;
  fast.twins = false;
  fast.fine_refinement = false;
  return fast;
}

GlobalSearch::GlobalSearch(const GlobalOptions& options) : options_(options), rotations_(options) {
  if (!options.free_space) weights_.violation = weights_.occluded = 0.0;
  if (!options.missing_data) weights_.empty = 0.0;
}

PrepareOptions GlobalSearch::prepare_options(bool reference) const {
  PrepareOptions prepare;
  prepare.sparse_points = options_.sparse_points;
  prepare.middle_points = options_.middle_points;
  prepare.with_table = reference;
  prepare.adaptive_scale = options_.adaptive_scale;
  prepare.noise_weights = options_.noise_weights;
  if (!options_.free_space) prepare.values.free = prepare.values.unknown;
  if (!options_.missing_data) prepare.values.empty = prepare.values.unknown;
  return prepare;
}

// Fills window_ for translations around `centre`; returns what points outside of the table add to every sum.
int GlobalSearch::correlate(const PreparedScan& reference, const PreparedScan& scan, const Pose2& centre) {
  const ScoreTable& table = reference.table;
  const auto frame_low = static_cast<float>(kWindow / 2),
             frame_high = static_cast<float>(ScoreTable::kStride - kWindow / 2);
  const auto c = static_cast<float>(std::cos(centre.theta)), s = static_cast<float>(std::sin(centre.theta));
  const auto tx = static_cast<float>(centre.x), ty = static_cast<float>(centre.y);
  const std::size_t count = scan.sparse.count;
  at_u_.resize(count);
  at_v_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const float px = scan.sparse.x[i], py = scan.sparse.y[i];
    at_u_[i] = table.position(c * px - s * py + tx);
    at_v_[i] = table.position(s * px + c * py + ty);
  }
  offsets_.resize(count);
  std::size_t inside = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const float u = at_u_[i], v = at_v_[i];
    if (!(u >= frame_low && v >= frame_low && u < frame_high && v < frame_high)) continue;
    offsets_[inside++] = (static_cast<int>(v) - kWindow / 2) * ScoreTable::kStride + static_cast<int>(u) - kWindow / 2;
  }
  correlate_points(table.data(), std::span(offsets_).first(inside), window_);
  return table.values().unknown * static_cast<int>(count - inside);
}

void GlobalSearch::sweep(const PreparedScan& reference, const PreparedScan& scan, const std::optional<Pose2>& guess) {
  coarse_.clear();
  const Pose2 centre = guess.value_or(Pose2{});
  for (const RotationHypothesis& rotation : rotation_list_) {
    const Pose2 at{centre.x, centre.y, rotation.theta};
    const int outside = correlate(reference, scan, at);
    const CorrelationPeak first = highest_peak(window_);
    coarse_.push_back({shifted(at, reference.table, first), first.sum + outside, 0.0, rotation.source});
    const CorrelationPeak second = take_next_peak(window_, first, kPeakCells);
    coarse_.push_back({shifted(at, reference.table, second), second.sum + outside, 0.0, rotation.source});
  }
}

// Best first, without those that a better neighbour stands for.
void GlobalSearch::thin(const PreparedScan& reference, std::size_t most) {
  std::sort(coarse_.begin(), coarse_.end(), coarsely_better);
  kept_.clear();
  const double near_m = 2.5 * static_cast<double>(reference.table.cell());
  const double near_rad = deg_to_rad(1.2 * options_.sweep_step_deg);
  for (const Hypothesis& h : coarse_) {
    if (h.coarse < options_.coarse_share * coarse_.front().coarse) break;
    const bool known = std::any_of(kept_.begin(), kept_.end(), [&](const Hypothesis& k) {
      return same_pose(h.T_ref_scan, k.T_ref_scan, near_m, near_rad);
    });
    if (known) continue;
    kept_.push_back(h);
    if (kept_.size() >= most) break;
  }
}

void GlobalSearch::refine_quickly(const PreparedScan& reference, const PreparedScan& scan, Hypothesis& hypothesis) {
  PointToLineOptions quick;
  quick.gate_start_m = kQuickGateStart * reference.scale_m;
  quick.gate_end_m = kGateEnd * reference.scale_m;
  quick.max_iterations = options_.refinement ? 3 : 0;
  quick.stop_m = 1e-3 * reference.scale_m;
  quick.stop_rad = 1e-3;
  hypothesis.T_ref_scan = refine_point_to_line(reference.model(), scan.model(), hypothesis.T_ref_scan, quick,
                                               scan.sparse, nullptr, refinement_)
                              .T_ref_scan;
  hypothesis.score = weigh_evidence(reference, scan, reference.sparse, scan.sparse, hypothesis.T_ref_scan,
                                    kQuickSlack * reference.scale_m)
                         .score(weights_);
}

void GlobalSearch::refine_candidates(const PreparedScan& reference, const PreparedScan& scan) {
  for (Hypothesis& h : kept_) refine_quickly(reference, scan, h);
  std::sort(kept_.begin(), kept_.end(), better);
}

// A room that looks the same after a quarter or half turn explains the scan at a place that may lie far outside the
// window: looked for there, so that the answer can say so.
void GlobalSearch::add_twins(const PreparedScan& reference, const PreparedScan& scan) {
  const int best_coarse = std::max_element(kept_.begin(), kept_.end(), [](const auto& a, const auto& b) {
                            return a.coarse < b.coarse;
                          })->coarse;
  const double theta = kept_.front().T_ref_scan.theta;
  const double reach = 0.5 * kWindow * static_cast<double>(reference.table.cell());
  for (const double turn : {0.5 * kPi, kPi, -0.5 * kPi}) {
    for (const auto& [x, y] :
         {std::pair{-reach, -reach}, std::pair{reach, -reach}, std::pair{-reach, reach}, std::pair{reach, reach}}) {
      const Pose2 at{x, y, wrap_angle(theta + turn)};
      const int outside = correlate(reference, scan, at);
      const CorrelationPeak peak = highest_peak(window_);
      Hypothesis twin{shifted(at, reference.table, peak), peak.sum + outside, 0.0, RotationSource::kSweep};
      if (twin.coarse < kTwinShare * best_coarse) continue;
      refine_quickly(reference, scan, twin);
      kept_.push_back(twin);
    }
  }
}

void GlobalSearch::refine_finalists(const PreparedScan& reference, const PreparedScan& scan, SearchOutcome& out) {
  const double scale = reference.scale_m;
  sort_distinct(kept_, scale, out.hypotheses);
  keep_finalists(static_cast<std::size_t>(options_.finalists), out.hypotheses);
  PointToLineOptions middle;
  middle.gate_start_m = kMiddleGateStart * scale;
  middle.gate_end_m = kGateEnd * scale;
  middle.max_iterations = options_.refinement ? 3 : 0;
  kept_ = out.hypotheses;
  for (Hypothesis& h : kept_) {
    h.T_ref_scan = refine_point_to_line(reference.model(), scan.model(), h.T_ref_scan, middle, scan.middle,
                                        options_.both_ways ? &reference.middle : nullptr, refinement_)
                       .T_ref_scan;
    h.score = weigh_evidence(reference, scan, reference.middle, scan.middle, h.T_ref_scan, kFineSlack * scale)
                  .score(weights_);
  }
  sort_distinct(kept_, scale, out.hypotheses);
}

void GlobalSearch::settle(const PreparedScan& reference, const PreparedScan& scan, SearchOutcome& out) {
  const double scale = reference.scale_m;
  Hypothesis& best = out.hypotheses.front();
  PointToLineOptions fine;
  fine.gate_start_m = kFineGateStart * scale;
  fine.gate_end_m = kGateEnd * scale;
  fine.max_iterations = !options_.refinement ? 0 : options_.fine_refinement ? 3 : 2;
  const SurfaceBatch& of_scan = options_.fine_refinement ? scan.all : scan.middle;
  const SurfaceBatch& of_ref = options_.fine_refinement ? reference.all : reference.middle;
  const auto weigh = [&](const Pose2& pose) {
    return weigh_evidence(reference, scan, reference.middle, scan.middle, pose, kFineSlack * scale);
  };
  for (int attempt = 0; attempt < kSettleAttempts; ++attempt) {
    out.refined = refine_point_to_line(reference.model(), scan.model(), best.T_ref_scan, fine, of_scan,
                                       options_.both_ways ? &of_ref : nullptr, refinement_);
    best.T_ref_scan = out.refined.T_ref_scan;
    out.evidence = weigh(best.T_ref_scan);
    best.score = out.evidence.score(weights_);
    // A little way along the direction that the surfaces hold least: a better place, or how much worse it gets.
    const Eigen::Vector2d weakest = weakest_direction(out.refined.information);
    out.profile = 2.0;
    Hypothesis other = best;
    for (const double step : kSlideSteps) {
      const Pose2 moved = slid(best.T_ref_scan, step * scale * weakest);
      const double score = weigh(moved).score(weights_);
      out.profile = std::min(out.profile, best.score - score);
      if (score > other.score) {
        other.score = score;
        other.T_ref_scan = moved;
      }
    }
    if (other.score <= best.score + kWorthASlide) break;
    if (attempt + 1 < kSettleAttempts) best.T_ref_scan = other.T_ref_scan;
  }
  out.residual_covariance = covariance_of_residuals(reference.model(), scan.model(), best.T_ref_scan,
                                                    {fine.gate_end_m, 0.0, fine.min_normal_cosine}, of_scan,
                                                    options_.both_ways ? &of_ref : nullptr, refinement_, runs_);
  out.reference_turn_variance = reference.turn_variance;
  out.scan_turn_variance = scan.turn_variance;
  if (out.profile < kDoubtfulProfile) {
    // A few hits tell how far along a corridor the sensor is: all of them are asked.
    const Eigen::Vector2d weakest = weakest_direction(out.refined.information);
    const auto score = [&](double step) {
      return weigh_evidence(reference, scan, reference.all, scan.all, slid(best.T_ref_scan, step * scale * weakest),
                            kFineSlack * scale)
          .score(weights_);
    };
    const double here = score(0.0);
    out.profile = 2.0;
    for (const double step : kSlideSteps) out.profile = std::min(out.profile, here - score(step));
  }
  out.margin = best.score + 2.0;
  for (std::size_t k = 1; k < out.hypotheses.size(); ++k) {
    if (same_answer(out.hypotheses[k].T_ref_scan, best.T_ref_scan, scale)) continue;
    out.margin = best.score - out.hypotheses[k].score;
    break;
  }
}

// Hypotheses from the listed rotations, refined and weighed, in kept_.
void GlobalSearch::look(const PreparedScan& reference, const PreparedScan& scan, const std::optional<Pose2>& guess,
                        int candidates, MatchTimer& timer) {
  sweep(reference, scan, guess);
  thin(reference, static_cast<std::size_t>(candidates));
  timer.end_of(&MatchTimes::translation);
  refine_candidates(reference, scan);
  if (options_.twins && !guess) add_twins(reference, scan);
  timer.end_of(&MatchTimes::refine);
}

// Whether the best of kept_ explains the scans well and, without a guess, clearly better than the next distinct one.
bool GlobalSearch::convinces(const PreparedScan& reference, bool guessed) const {
  if (kept_.empty()) return false;
  const Hypothesis& best = *std::max_element(
      kept_.begin(), kept_.end(), [](const Hypothesis& a, const Hypothesis& b) { return a.score < b.score; });
  return best.score >= kSureScore && (guessed || std::none_of(kept_.begin(), kept_.end(), [&](const Hypothesis& h) {
                                        return h.score > best.score - kSureMargin &&
                                               !same_answer(h.T_ref_scan, best.T_ref_scan, reference.scale_m);
                                      }));
}

void GlobalSearch::run(const PreparedScan& reference, const PreparedScan& scan, const std::optional<Pose2>& guess,
                       const std::vector<RotationHypothesis>* proposed, SearchOutcome& out, MatchTimer* given_timer) {
  out.hypotheses.clear();
  out.margin = out.profile = 0.0;
  out.refined = {};
  out.evidence = {};
  if (reference.size() == 0 || scan.size() == 0) return;
  MatchTimer own_timer;
  MatchTimer& timer = given_timer != nullptr ? *given_timer : own_timer;
  rotations_.list(reference, scan, guess, proposed, rotation_list_);
  timer.end_of(&MatchTimes::rotation);
  look(reference, scan, guess, options_.candidates, timer);
  bool guessed = guess.has_value();
  const bool may_sweep = proposed == nullptr && options_.rotations == RotationSearch::kAutomatic;
  if (may_sweep && !convinces(reference, guessed)) {
    // A guess that leads nowhere is given up: what it led to stands beside what is found everywhere.
    of_guess_.clear();
    if (guessed) of_guess_ = kept_;
    guessed = false;
    rotations_.list_all(rotation_list_);
    look(reference, scan, std::nullopt, kMoreInDoubt * options_.candidates, timer);
    kept_.insert(kept_.end(), of_guess_.begin(), of_guess_.end());
  }
  refine_finalists(reference, scan, out);
  if (!guessed) prefer_less_turn(kTieMargin, out.hypotheses);
  settle(reference, scan, out);
  // Along a corridor each twin is best where the noise happens to suit it.
  if (!guessed && out.profile < kFlatProfile && prefer_less_turn(kSlidingTieMargin, out.hypotheses))
    settle(reference, scan, out);
  timer.end_of(&MatchTimes::refine);
}

}  // namespace phasescan
