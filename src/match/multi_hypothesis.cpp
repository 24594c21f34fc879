#include "phasescan/match/multi_hypothesis.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace phasescan {
namespace {

constexpr int kWindow = CorrelationWindow::kWindow;
constexpr int kSlides = 2;
constexpr double kFineSlack = 0.0015;
constexpr double kTwinShare = 0.85;  // of the best coarse sum: worth a closer look

bool same_pose(const Pose2& a, const Pose2& b, double metres, double radians) {
  return translation_distance(a, b) < metres && angle_distance(a.theta, b.theta) < radians;
}

// The pose at a peak of the window around `centre`.
Pose2 shifted(const Pose2& centre, const ScoreTable& table, const CorrelationPeak& peak) {
  const auto cell = static_cast<double>(table.cell());
  return {centre.x + cell * (peak.column - kWindow / 2), centre.y + cell * (peak.row - kWindow / 2), centre.theta};
}

}  // namespace

// Fills window_ for translations around `centre`; returns what points outside of the table add to every sum.
int MultiHypothesisSearch::correlate(const PreparedScan& reference, const PreparedScan& scan, const Pose2& centre) {
  const ScoreTable& table = reference.table;
  const auto frame_low = static_cast<float>(kWindow / 2), frame_high = static_cast<float>(ScoreTable::kStride - kWindow / 2);
  const auto c = static_cast<float>(std::cos(centre.theta)), s = static_cast<float>(std::sin(centre.theta));
  const auto tx = static_cast<float>(centre.x), ty = static_cast<float>(centre.y);
  offsets_.clear();
  for (std::size_t i = 0; i < scan.sparse.count; ++i) {
    const float px = scan.sparse.x[i], py = scan.sparse.y[i];
    const float u = table.position(c * px - s * py + tx), v = table.position(s * px + c * py + ty);
    if (!(u >= frame_low && v >= frame_low && u < frame_high && v < frame_high)) continue;
    offsets_.push_back((static_cast<int>(v) - kWindow / 2) * ScoreTable::kStride + static_cast<int>(u) - kWindow / 2);
  }
  correlate_points(table.data(), offsets_, window_);
  return table.values().unknown * static_cast<int>(scan.sparse.count - offsets_.size());
}

void MultiHypothesisSearch::sweep(const PreparedScan& reference, const PreparedScan& scan, const Pose2& centre) {
  coarse_.clear();
  const int steps = std::max(1, static_cast<int>(std::lround(360.0 / options_.sweep_step_deg)));
  for (int k = 0; k < steps; ++k) {
    const Pose2 at{centre.x, centre.y, wrap_angle(centre.theta + kTwoPi * k / steps)};
    const int outside = correlate(reference, scan, at);
    const CorrelationPeak first = highest_peak(window_);
    coarse_.push_back({shifted(at, reference.table, first), first.sum + outside, 0.0, RotationSource::kSweep});
    const CorrelationPeak second = take_next_peak(window_, first, 3);
    coarse_.push_back({shifted(at, reference.table, second), second.sum + outside, 0.0, RotationSource::kSweep});
  }
}

// A room that looks the same after a quarter or half turn explains the scan at a place that may lie far outside the window:
// looked for there, so that the answer can say so.
void MultiHypothesisSearch::add_twins(const PreparedScan& reference, const PreparedScan& scan, double theta) {
  coarse_.clear();
  const double reach = 0.5 * kWindow * static_cast<double>(reference.table.cell());
  for (const double turn : {0.5 * kPi, kPi, -0.5 * kPi}) {
    for (const auto& [x, y] : {std::pair{-reach, -reach}, std::pair{reach, -reach}, std::pair{-reach, reach}, std::pair{reach, reach}}) {
      const Pose2 at{x, y, wrap_angle(theta + turn)};
      const int outside = correlate(reference, scan, at);
      const CorrelationPeak peak = highest_peak(window_);
      coarse_.push_back({shifted(at, reference.table, peak), peak.sum + outside, 0.0, RotationSource::kSweep});
    }
  }
}

// Best first, without those that a better neighbour stands for.
void MultiHypothesisSearch::thin(const PreparedScan& reference) {
  std::stable_sort(coarse_.begin(), coarse_.end(), [](const Hypothesis& a, const Hypothesis& b) { return a.coarse > b.coarse; });
  kept_.clear();
  const double near_m = 2.5 * static_cast<double>(reference.table.cell());
  const double near_rad = deg_to_rad(1.2 * options_.sweep_step_deg);
  for (const Hypothesis& h : coarse_) {
    if (h.coarse < options_.coarse_share * coarse_.front().coarse) break;
    const bool known = std::any_of(kept_.begin(), kept_.end(), [&](const Hypothesis& k) { return same_pose(h.T_ref_scan, k.T_ref_scan, near_m, near_rad); });
    if (known) continue;
    kept_.push_back(h);
    if (kept_.size() >= static_cast<std::size_t>(options_.candidates)) break;
  }
}

void MultiHypothesisSearch::run(const PreparedScan& reference, const PreparedScan& scan, const std::optional<Pose2>& guess,
                                SearchOutcome& out) {
  out.hypotheses.clear();
  out.margin = out.profile = 0.0;
  out.refined = {};
  out.evidence = {};
  sweep(reference, scan, guess.value_or(Pose2{}));
  thin(reference);
  const double scale = reference.scale_m;
  const EvidenceWeights weights;
  const SurfaceModel ref_model = reference.model(), scan_model = scan.model();

  // Quick refinement with few points, one way.
  PointToLineOptions quick;
  quick.gate_start_m = 0.075 * scale;
  quick.gate_end_m = 0.035 * scale;
  quick.max_iterations = 3;
  quick.stop_m = 1e-3 * scale;
  quick.stop_rad = 1e-3;
  for (Hypothesis& h : kept_) {
    h.T_ref_scan = refine_point_to_line(ref_model, scan_model, h.T_ref_scan, quick, scan.sparse, nullptr).T_ref_scan;
    h.score = weigh_evidence(reference, scan, reference.sparse, scan.sparse, h.T_ref_scan, 0.01 * scale).score(weights);
  }
  const int best_coarse = kept_.front().coarse;
  const auto better = [](const Hypothesis& a, const Hypothesis& b) { return a.score > b.score; };
  std::stable_sort(kept_.begin(), kept_.end(), better);
  const double distinct_m = std::max(0.02 * scale, 0.05), distinct_rad = deg_to_rad(4.0);
  const auto keep_distinct = [&](std::vector<Hypothesis>& all) {
    std::vector<Hypothesis>& distinct = out.hypotheses;
    distinct.clear();
    for (const Hypothesis& h : all) {
      const bool known = std::any_of(distinct.begin(), distinct.end(), [&](const Hypothesis& k) { return same_pose(h.T_ref_scan, k.T_ref_scan, distinct_m, distinct_rad); });
      if (!known) distinct.push_back(h);
    }
  };
  add_twins(reference, scan, kept_.front().T_ref_scan.theta);
  for (Hypothesis& h : coarse_) {
    if (h.coarse < kTwinShare * best_coarse) continue;
    h.T_ref_scan = refine_point_to_line(ref_model, scan_model, h.T_ref_scan, quick, scan.sparse, nullptr).T_ref_scan;
    h.score = weigh_evidence(reference, scan, reference.sparse, scan.sparse, h.T_ref_scan, 0.01 * scale).score(weights);
    kept_.push_back(h);
  }
  std::stable_sort(kept_.begin(), kept_.end(), better);
  keep_distinct(kept_);
  if (out.hypotheses.size() > static_cast<std::size_t>(options_.finalists)) out.hypotheses.resize(static_cast<std::size_t>(options_.finalists));

  PointToLineOptions middle = quick;
  middle.gate_start_m = 0.05 * scale;
  middle.max_iterations = 3;
  for (Hypothesis& h : out.hypotheses) {
    h.T_ref_scan = refine_point_to_line(ref_model, scan_model, h.T_ref_scan, middle, scan.middle, &reference.middle).T_ref_scan;
    h.score = weigh_evidence(reference, scan, reference.middle, scan.middle, h.T_ref_scan, kFineSlack * scale).score(weights);
  }
  kept_ = out.hypotheses;
  std::stable_sort(kept_.begin(), kept_.end(), better);
  keep_distinct(kept_);
  if (out.hypotheses.empty()) return;

  Hypothesis& best = out.hypotheses.front();
  PointToLineOptions fine;
  fine.gate_start_m = 0.04 * scale;
  fine.gate_end_m = 0.035 * scale;
  fine.max_iterations = 2;
  const auto weigh = [&](const Pose2& pose) { return weigh_evidence(reference, scan, reference.middle, scan.middle, pose, kFineSlack * scale); };
  for (int attempt = 0; attempt < kSlides; ++attempt) {
    out.refined = refine_point_to_line(ref_model, scan_model, best.T_ref_scan, fine);
    best.T_ref_scan = out.refined.T_ref_scan;
    out.evidence = weigh(best.T_ref_scan);
    best.score = out.evidence.score(weights);
    // A little way along the direction that the surfaces hold least: a better place, or how much worse it gets.
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen;
    eigen.computeDirect(Eigen::Matrix2d(out.refined.information.topLeftCorner<2, 2>()));
    const Eigen::Vector2d weakest = eigen.eigenvectors().col(0);
    out.profile = 1e9;
    Hypothesis slid = best;
    for (const double step : {-0.05, -0.02, 0.02, 0.05}) {
      Pose2 moved = best.T_ref_scan;
      moved.x += step * scale * weakest.x();
      moved.y += step * scale * weakest.y();
      const double score = weigh(moved).score(weights);
      out.profile = std::min(out.profile, best.score - score);
      if (score > slid.score) {
        slid.score = score;
        slid.T_ref_scan = moved;
      }
    }
    if (slid.score <= best.score + 0.01) break;
    if (attempt + 1 < kSlides) best.T_ref_scan = slid.T_ref_scan;
  }
  out.margin = best.score + 2.0;
  for (std::size_t k = 1; k < out.hypotheses.size(); ++k) {
    if (same_pose(out.hypotheses[k].T_ref_scan, best.T_ref_scan, distinct_m, distinct_rad)) continue;
    out.margin = best.score - out.hypotheses[k].score;
    break;
  }
}

}  // namespace phasescan
