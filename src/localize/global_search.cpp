#include "localize/global_search.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "localize/likelihood.hpp"
#include "odometry/information.hpp"

namespace phasescan {
namespace {

constexpr int kFirstSteps = 2, kNextSteps = 4;
constexpr float kFirstGateM = 0.6F, kNextGateM = 0.3F, kGateShrink = 0.65F, kCoarseCosine = 0.6F;
constexpr std::size_t kFirstStride = 2;           // of the sparse hits, in the first steps
constexpr std::size_t kCoarseStride = 3;          // of the judged beams, for candidates
constexpr double kSameM = 0.15, kSameRad = 0.06;  // candidates this near each other lead to one pose
constexpr std::size_t kPerFinalist = 6;           // candidates that are looked at once more for each finalist
constexpr std::size_t kJudgedPerFinalist = 2;     // of these, those whose rays are followed
constexpr std::size_t kLeastCandidates = 80, kViewsPerCandidate = 8;
// What a match is off by beside what it claims: the map's cells [cells] and its walls' directions [rad].
constexpr double kMapSigmaCells = 0.3, kMapSigmaRad = 0.003;

/// Point-to-line steps with a wide gate: from a lattice place to the pose near it.
struct Descent {
  int steps = 2;
  float gate_m = 0.6F;
  std::size_t stride = 1;  ///< every so many hits alone
};
Pose2 descend(const LocalMap& map, const MapPoints& points, const Pose2& start, const Descent& how) {
  Pose2 T = start;
  float gate = how.gate_m;
  for (int step_count = 0; step_count < how.steps; ++step_count, gate *= kGateShrink) {
    const auto c = static_cast<float>(std::cos(T.theta)), s = static_cast<float>(std::sin(T.theta));
    const auto tx = static_cast<float>(T.x), ty = static_cast<float>(T.y);
    float h[6] = {1.0F, 0.0F, 0.0F, 1.0F, 0.0F, 1.0F}, g[3] = {0.0F, 0.0F, 0.0F};
    const float soft = 0.25F * gate * gate;
    for (std::size_t i = 0; i < points.size(); i += how.stride) {
      const float rx = c * points.x[i] - s * points.y[i], ry = s * points.x[i] + c * points.y[i];
      const float nx = c * points.nx[i] - s * points.ny[i], ny = s * points.nx[i] + c * points.ny[i];
      const Surfel* const q = map.find(rx + tx, ry + ty, nx, ny, kCoarseCosine);
      if (q == nullptr) continue;
      const float e = (rx + tx - q->x) * q->nx + (ry + ty - q->y) * q->ny;
      if (std::fabs(e) > gate) continue;
      const float kernel = 1.0F / (1.0F + e * e / soft), w = kernel * kernel, turn = rx * q->ny - ry * q->nx;
      h[0] += w * q->nx * q->nx, h[1] += w * q->nx * q->ny, h[2] += w * q->nx * turn;
      h[3] += w * q->ny * q->ny, h[4] += w * q->ny * turn, h[5] += w * turn * turn;
      g[0] += w * e * q->nx, g[1] += w * e * q->ny, g[2] += w * e * turn;
    }
    Eigen::Matrix3f H;
    H << h[0], h[1], h[2], h[1], h[3], h[4], h[2], h[4], h[5];
    const Eigen::Vector3f step = H.inverse() * Eigen::Vector3f(g[0], g[1], g[2]);  // at least 1 on the diagonal
    if (!step.allFinite()) return start;
    T = {T.x - static_cast<double>(step.x()), T.y - static_cast<double>(step.y()),
         wrap_angle(T.theta - static_cast<double>(step.z()))};
  }
  return T;
}

struct Candidate {
  Pose2 T_grid_base;
  double score = 0.0;
};

bool near(const Pose2& a, const Pose2& b) {
  return std::abs(a.x - b.x) < kSameM && std::abs(a.y - b.y) < kSameM && angle_distance(a.theta, b.theta) < kSameRad;
}

/// The best by score, none near another.
std::vector<Candidate> best_apart(std::vector<Candidate> all, std::size_t most) {
  std::stable_sort(all.begin(), all.end(), [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  std::vector<Candidate> kept;
  for (const Candidate& candidate : all) {
    if (kept.size() >= most) break;
    const bool known = std::any_of(kept.begin(), kept.end(),
                                   [&](const Candidate& k) { return near(k.T_grid_base, candidate.T_grid_base); });
    if (!known) kept.push_back(candidate);
  }
  return kept;
}

/// Where a few steps lead from a pose, and how well that explains a part of the scan.
Candidate candidate_near(const LocalizationMap::Data& map, const QueryScan& scan, const Pose2& T_grid_base,
                         const Descent& how, std::size_t stride) {
  const Pose2& T_grid_map = map.coarse.T_world_map();
  Candidate candidate;
  candidate.T_grid_base = T_grid_map * descend(map.coarse, scan.sparse, T_grid_map.inverse() * T_grid_base, how);
  candidate.score = fit_to_map(map.grid, scan.beams, candidate.T_grid_base, false, stride).log_likelihood;
  return candidate;
}

/// Poses near the views that look like the scan.
std::vector<Candidate> candidates_of(const LocalizationMap::Data& map, const QueryScan& scan,
                                     const SearchEffort& effort, GlobalSearchWorkspace& work) {
  // Of a small map a small part of the views is enough.
  const std::size_t most = std::min(effort.candidates, kLeastCandidates + map.views.size() / kViewsPerCandidate);
  match_views(map.views, scan.view, most, work.views);
  const Pose2 T_laser_base = scan.T_base_laser.inverse();
  std::vector<Candidate> candidates;
  candidates.reserve(work.views.best.size());
  for (const ViewMatch& match : work.views.best) {
    const double heading = kTwoPi * match.turn / static_cast<double>(kViewDirections);
    const Pose2 T_grid_laser{static_cast<double>(map.views.x[match.view]), static_cast<double>(map.views.y[match.view]),
                             wrap_angle(heading)};
    candidates.push_back(candidate_near(map, scan, T_grid_laser * T_laser_base,
                                        {kFirstSteps, kFirstGateM, kFirstStride}, kCoarseStride));
  }
  candidates = best_apart(std::move(candidates), kPerFinalist * effort.finalists);
  for (Candidate& candidate : candidates)
    candidate = candidate_near(map, scan, candidate.T_grid_base, {kNextSteps, kNextGateM, 1}, 1);
  return best_apart(std::move(candidates), kJudgedPerFinalist * effort.finalists);
}

}  // namespace

bool is_apart(const Pose2& a, const Pose2& b) {
  return translation_distance(a, b) > kApartM || angle_distance(a.theta, b.theta) > kApartRad;
}

FoundPose match_near(const LocalizationMap::Data& map, const QueryScan& scan, const Pose2& T_grid_base,
                     const std::optional<PosePrior>& prior) {
  const Registration found = register_on_grid(map.fine, scan.points, T_grid_base, {}, prior);
  FoundPose pose;
  pose.T_grid_base = found.T_map_base;
  pose.fit = fit_to_map(map.grid, scan.beams, pose.T_grid_base);
  Eigen::Matrix3d information = kMatchTrust * found.information;
  if (prior) information += prior->information * kMatchTrust;
  information.diagonal() += Eigen::Vector3d(1e-3, 1e-3, 1e-3);  // nothing is known better than to 30 m
  pose.covariance = information.inverse();
  const double of_map = kMapSigmaCells * static_cast<double>(map.grid.cell_m);
  pose.covariance.diagonal() += Eigen::Vector3d(of_map * of_map, of_map * of_map, kMapSigmaRad * kMapSigmaRad);
  return pose;
}

std::vector<FoundPose> search_map(const LocalizationMap::Data& map, const QueryScan& scan, const SearchEffort& effort,
                                  GlobalSearchWorkspace& work) {
  std::vector<FoundPose> found;
  if (!scan.usable()) return found;
  std::vector<Candidate> candidates = candidates_of(map, scan, effort, work);
  for (Candidate& candidate : candidates)
    candidate.score = fit_to_map(map.grid, scan.beams, candidate.T_grid_base).log_likelihood;
  for (const Candidate& candidate : best_apart(std::move(candidates), effort.finalists))
    found.push_back(match_near(map, scan, candidate.T_grid_base));
  std::stable_sort(found.begin(), found.end(),
                   [](const FoundPose& a, const FoundPose& b) { return a.fit.log_likelihood > b.fit.log_likelihood; });
  std::vector<FoundPose> apart;
  for (const FoundPose& pose : found) {
    const bool known = std::any_of(apart.begin(), apart.end(),
                                   [&](const FoundPose& k) { return !is_apart(k.T_grid_base, pose.T_grid_base); });
    if (!known) apart.push_back(pose);
  }
  return apart;
}

}  // namespace phasescan
