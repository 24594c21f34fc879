#include "localize/locate.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "localize/pose_confidence.hpp"
#include "odometry/information.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kMoreEffort = 6;  // times the candidates, where the first answer does not convince
constexpr double kWellExplained = 0.7;  // share of the hits: another pose that does better is not to be expected
// A pose less likely than this is none to go by: of scans from rooms that the map has not, one in seventy is above it
// at a wrong place.
constexpr double kDegradedConfidence = 0.8;
constexpr double kLeastOfAnswer = 0.35;  // less of a scan is no answer

/// What a turn of the whole revolution adds: the scan is turned about the laser, and the base with it.
Eigen::Matrix3d turn_covariance(const Pose2& T_map_base, const Pose2& T_base_laser, double turn_deg) {
  if (!(turn_deg > 0.0)) return Eigen::Matrix3d::Zero();
  const Pose2 T_map_laser = T_map_base * T_base_laser;
  const Eigen::Vector3d around(T_map_laser.y - T_map_base.y, T_map_base.x - T_map_laser.x, 1.0);
  const double turn = deg_to_rad(turn_deg);
  return turn * turn * around * around.transpose();
}

double margin_of(const std::vector<FoundPose>& found) {
  if (found.size() < 2) return found.empty() ? 0.0 : kMostMargin;
  return found[0].fit.log_likelihood - found[1].fit.log_likelihood;
}

Judged judge(double explained, double confidence, double margin, const LocalizeOptions& options) {
  Judged judged;
  judged.confidence = confidence;
  const bool ambiguous = margin < options.ambiguous_gap;
  if (explained < kLeastOfAnswer) {
    judged.status = TrackingStatus::kLost;
  } else if (ambiguous) {
    judged.status = TrackingStatus::kAmbiguous;
    judged.confidence = std::min(judged.confidence, options.min_confidence);
  } else if (judged.confidence > options.min_confidence) {
    judged.status = TrackingStatus::kOk;
  } else {
    judged.status = judged.confidence > kDegradedConfidence ? TrackingStatus::kDegraded : TrackingStatus::kLost;
  }
  return judged;
}

}  // namespace

std::vector<FoundPose> search_thoroughly(const LocalizationMap::Data& map, const QueryScan& scan,
                                         const LocalizeOptions& options, GlobalSearchWorkspace& work) {
  SearchEffort effort{static_cast<std::size_t>(options.candidates), static_cast<std::size_t>(options.finalists)};
  std::vector<FoundPose> found = search_map(map, scan, effort, work);
  if (found.empty()) return found;
  const FoundPose& best = found.front();
  const bool explained = best.fit.explained > kWellExplained && best.fit.contradicting < 0.1;
  if (explained || pose_confidence(evidence_of(best, margin_of(found))) > options.min_confidence) return found;
  effort.candidates *= kMoreEffort;
  effort.finalists *= kMoreEffort;
  return search_map(map, scan, effort, work);
}

Judged judge_pose(const FoundPose& pose, double margin, const LocalizeOptions& options) {
  return judge(pose.fit.explained, pose_confidence(evidence_of(pose, margin)), margin, options);
}

Judged judge_followed(const FoundPose& pose, Led led, double margin, const LocalizeOptions& options) {
  PoseEvidence evidence = evidence_of(pose, margin);
  if (led == Led::kThere) evidence.explained = explained_of_known(pose.fit);
  return judge(evidence.explained, drive_confidence(evidence, led == Led::kThere), margin, options);
}

void report_hypotheses(const LocalizationMap::Data& map, const HypothesisSet& set, const Pose2& T_base_laser,
                       const LocalizeOptions& options, LocalizationUpdate& update) {
  if (set.empty()) return;
  for (std::size_t i = 0; i < set.all.size(); ++i) {
    const Hypothesis& h = set.all[i];
    PoseEstimate estimate;
    estimate.T_map_base = map.T_map_grid * h.at.T_grid_base;
    estimate.covariance = rotate_information(h.at.covariance, map.T_map_grid.theta) +
                          turn_covariance(estimate.T_map_base, T_base_laser, options.revolution_turn_deg);
    const double share = std::exp(h.weight - set.all.front().weight);
    estimate.confidence = i == 0 ? update.confidence : std::min(0.5, share * (1.0 - update.confidence));
    update.hypotheses.push_back(estimate);
  }
  update.margin = set.margin();
  update.fit = set.all.front().at.fit;
  update.T_map_base = update.hypotheses.front().T_map_base;
  update.covariance = update.hypotheses.front().covariance;
}

void check_measurement(const RangeMeasurement& measurement) {
  if (!measurement.T_base_laser.is_finite()) throw std::invalid_argument("T_base_laser: not finite");
  if (measurement.T_odom_base && !measurement.T_odom_base->is_finite())
    throw std::invalid_argument("T_odom_base: not finite");
}

LocalizationUpdate locate(const LocalizationMap& map, const RangeMeasurement& measurement,
                          const LocalizeOptions& options) {
  check_measurement(measurement);
  LocalizationUpdate update;
  update.stamp = measurement.scan.stamp;
  QueryWorkspace query_work;
  GlobalSearchWorkspace search_work;
  const QueryScan query = prepare_query(measurement, {}, options.view_range_m, true, query_work);
  if (!query.usable()) return update;
  update.searched = true;
  update.status = TrackingStatus::kLost;
  const std::vector<FoundPose> found = search_thoroughly(map.data(), query, options, search_work);
  if (found.empty()) return update;
  HypothesisSet set;
  set.restart(found, {}, options.ambiguous_gap, static_cast<std::size_t>(options.max_hypotheses));
  const Judged judged = judge_pose(set.all.front().at, margin_of(found), options);
  update.status = judged.status;
  update.confidence = judged.confidence;
  report_hypotheses(map.data(), set, measurement.T_base_laser, options, update);
  update.margin = std::min(margin_of(found), kMostMargin);
  return update;
}

}  // namespace phasescan
