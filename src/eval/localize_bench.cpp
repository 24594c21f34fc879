#include "eval/localize_bench.hpp"

#include "phasescan/core/time.hpp"

namespace phasescan {
namespace {

constexpr int kReliabilityBins = 10;
constexpr double kRightM = 0.1, kRightRad = 3.0 * kPi / 180.0;

bool is_within(double error_m, double error_rad) {
  return error_m < kRightM && error_rad < kRightRad;
}

}  // namespace

bool is_right(const Pose2& pose, const Pose2& truth) {
  return is_within(translation_distance(pose, truth), angle_distance(pose.theta, truth.theta));
}

bool LocalizeRow::right() const {
  return is_within(error_m, error_rad);
}

std::vector<LocalizeRow> answer_all(const LocalizationMap& map, const std::vector<LocalizeCase>& cases,
                                    const LocalizeOptions& options, const std::function<void(std::size_t)>& progress) {
  std::vector<LocalizeRow> rows;
  for (const LocalizeCase& one : cases) {
    LocalizeRow row;
    const double cpu = thread_cpu_seconds();
    row.update = locate(map, one.measurement, options);
    row.ms = 1e3 * (thread_cpu_seconds() - cpu);
    row.mapped = one.mapped;
    row.error_m = row.error_rad = 1e3;
    if (row.update.T_map_base) {
      row.error_m = translation_distance(*row.update.T_map_base, one.T_map_base);
      row.error_rad = angle_distance(row.update.T_map_base->theta, one.T_map_base.theta);
    }
    for (const PoseEstimate& h : row.update.hypotheses) row.named |= is_right(h.T_map_base, one.T_map_base);
    rows.push_back(std::move(row));
    progress(rows.size());
  }
  return rows;
}

LocalizeScore score_of(const std::vector<LocalizeRow>& rows) {
  LocalizeScore score;
  std::vector<double> ms, metres, degrees;
  std::vector<Judgement> judgements;
  for (const LocalizeRow& row : rows) {
    ++score.n;
    ms.push_back(row.ms);
    score.right += row.right();
    score.within_half_m += row.error_m < 0.5;
    if (row.right()) metres.push_back(row.error_m), degrees.push_back(rad_to_deg(row.error_rad));
    const TrackingStatus status = row.update.status;
    score.ok += status == TrackingStatus::kOk;
    score.right_ok += status == TrackingStatus::kOk && row.right();
    score.wrong_ok += status == TrackingStatus::kOk && !row.right();
    score.degraded += status == TrackingStatus::kDegraded;
    score.wrong_degraded += status == TrackingStatus::kDegraded && !row.right();
    score.unmapped += !row.mapped;
    score.ambiguous += status == TrackingStatus::kAmbiguous;
    score.ambiguous_named += status == TrackingStatus::kAmbiguous && row.named;
    score.lost += status == TrackingStatus::kLost;
    if (status != TrackingStatus::kAmbiguous && row.update.T_map_base)
      judgements.push_back({row.update.confidence, row.right()});
  }
  score.median_m = quantile(metres, 0.5);
  score.median_deg = quantile(degrees, 0.5);
  score.ms_p50 = quantile(ms, 0.5);
  score.ms_p99 = quantile(ms, 0.99);
  score.reliability = reliability(judgements, kReliabilityBins);
  score.calibration_error = calibration_error(judgements);
  return score;
}

}  // namespace phasescan
