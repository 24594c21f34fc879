#include "calibrate/stop.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace phasescan {
namespace {

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

/// A beam's share in the equations of a small motion.
struct BeamEquation {
  Eigen::Vector3d gradient;  ///< of the range by (x, y, theta)
  double change = 0.0;       ///< of the range [m]
  double sigma = 0.0;        ///< what a cheap sensor's range may be off by
};

/// Equations of the beams that both scans saw, where the reference's surface is smooth.
std::vector<BeamEquation> equations(const Stop& grid, const std::vector<float>& reference,
                                    const std::vector<float>& ranges) {
  constexpr double kBend_m = 0.05, kSteep = 3.0, kFar_m = 0.3;
  std::vector<BeamEquation> out;
  for (std::size_t i = 1; i + 1 < grid.beams; ++i) {
    const double before = reference[i - 1], here = reference[i], after = reference[i + 1], now = ranges[i];
    if (!(std::abs(after - 2.0 * here + before) < kBend_m) || !(std::abs(now - here) < kFar_m)) continue;
    const double bearing = grid.angle_min + static_cast<double>(i) * grid.step;
    const double along = 0.5 * (after - before) / grid.step, ratio = along / here;  // d(range) / d(bearing)
    if (std::abs(ratio) > kSteep) continue;
    const double c = std::cos(bearing), s = std::sin(bearing);
    out.push_back({{-(c + ratio * s), -(s - ratio * c), along}, now - here, 0.02 + 0.01 * here});
  }
  return out;
}

/// The trend of values over their index, from the first to the last, and its standard error.
std::pair<double, double> trend(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  double mean = 0.0, sum = 0.0, weight = 0.0, rest = 0.0;
  for (const double v : values) mean += v / n;
  const auto place = [&](std::size_t i) { return static_cast<double>(i) - 0.5 * (n - 1.0); };
  for (std::size_t i = 0; i < values.size(); ++i) {
    sum += place(i) * (values[i] - mean);
    weight += place(i) * place(i);
  }
  const double slope = sum / weight;
  for (std::size_t i = 0; i < values.size(); ++i) rest += std::pow(values[i] - mean - slope * place(i), 2);
  return {slope * (n - 1.0), std::sqrt(rest / (n - 2.0) / weight) * (n - 1.0)};
}

}  // namespace

Stop grid_of(const Scan& scan) {
  Stop grid;
  grid.beams = scan.size();
  if (scan.size() < 2) return grid;
  const auto last = static_cast<double>(scan.size() - 1);
  grid.angle_min = scan.angle(0);
  grid.step =
      scan.angles.empty() ? scan.geometry.angle_increment : (scan.angle(scan.size() - 1) - scan.angle(0)) / last;
  grid.closed = std::abs(std::abs(grid.step) * (last + 1.0) - kTwoPi) < 0.6 * std::abs(grid.step);
  return grid;
}

std::vector<float> on_grid(const Scan& scan, const Stop& grid) {
  if (scan.angles.empty() && scan.size() == grid.beams && scan.geometry.angle_increment == grid.step &&
      scan.geometry.angle_min == grid.angle_min)
    return scan.ranges;
  std::vector<float> ranges(grid.beams, kMissing);
  const double turn = kTwoPi / std::abs(grid.step);
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (!scan.is_hit(i)) continue;
    double place = std::fmod((scan.angle(i) - grid.angle_min) / grid.step, turn);
    if (place < -0.5) place += turn;
    if (place >= turn - 0.5) place -= turn;
    const double beam = std::floor(place + 0.5);
    if (beam >= 0.0 && beam < static_cast<double>(grid.beams)) ranges[static_cast<std::size_t>(beam)] = scan.ranges[i];
  }
  return ranges;
}

SmallMotion small_motion(const Stop& grid, const std::vector<float>& reference, const std::vector<float>& ranges) {
  const std::vector<BeamEquation> beams = equations(grid, reference, ranges);
  SmallMotion out;
  out.common = beams.size();
  constexpr std::size_t kLeast = 20;
  if (beams.size() < kLeast) return out;
  // A weak prior of 10 cm and 3 degrees keeps directions that no surface shows at 0.
  const Eigen::Vector3d prior(100.0, 100.0, 400.0);
  Eigen::Vector3d motion = Eigen::Vector3d::Zero();
  constexpr int kRounds = 5;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix3d normal = prior.asDiagonal();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const BeamEquation& b : beams) {
      const double off = (b.change - b.gradient.dot(motion)) / b.sigma;
      const double weight = 1.0 / (b.sigma * b.sigma * (1.0 + off * off));
      normal += weight * b.gradient * b.gradient.transpose();
      right += weight * b.change * b.gradient;
    }
    motion = normal.ldlt().solve(right);
  }
  out.x = motion.x();
  out.y = motion.y();
  out.theta = motion.z();
  std::size_t agreeing = 0;
  for (const BeamEquation& b : beams) agreeing += std::abs(b.change - b.gradient.dot(motion)) < 2.0 * b.sigma;
  out.agreeing = static_cast<double>(agreeing) / static_cast<double>(beams.size());
  return out;
}

bool StopFinder::wheels_rest(const std::optional<Pose2>& odometry) const {
  if (!odometry_ || !odometry) return true;
  return translation_distance(*odometry, *odometry_) < options_.wheels_still_m &&
         std::abs(wrap_angle(odometry->theta - odometry_->theta)) < deg_to_rad(options_.wheels_still_deg);
}

void StopFinder::begin(const Scan& scan, const std::optional<Pose2>& odometry) {
  scans_.assign(1, scan);
  grid_ = grid_of(scan);
  reference_ = on_grid(scan, grid_);
  motions_.assign(1, {});
  odometry_ = odometry;
  odd_ = 0;
}

std::optional<Stop> StopFinder::end() {
  std::vector<Scan> scans = std::move(scans_);
  std::vector<SmallMotion> motions = std::move(motions_);
  scans_.clear();
  motions_.clear();
  // Without wheels nobody says when the robot began to brake or to start: more of the ends is left out.
  const std::size_t ends = odometry_ ? 1 : 3;
  if (scans.size() < options_.least_scans + 2 * (ends - 1)) return {};
  for (double SmallMotion::*part : {&SmallMotion::x, &SmallMotion::y, &SmallMotion::theta}) {
    std::vector<double> values;
    for (std::size_t i = 1; i < motions.size(); ++i) values.push_back(motions[i].*part);
    const auto [drift, error] = trend(values);
    const double most = part == &SmallMotion::theta ? 0.1 * deg_to_rad(options_.still_deg) : options_.drift_m;
    if (std::abs(drift) > std::max(most, 4.0 * error)) return {};
  }
  // The grid of the beam count that most scans have.
  std::map<std::size_t, std::size_t> counts;
  for (const Scan& scan : scans) ++counts[scan.size()];
  const auto most =
      std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  const auto like = std::find_if(scans.begin(), scans.end(), [&](const Scan& s) { return s.size() == most->first; });
  Stop stop = grid_of(*like);
  for (std::size_t i = ends; i + ends < scans.size(); ++i) stop.ranges.push_back(on_grid(scans[i], stop));
  return stop;
}

std::optional<Stop> StopFinder::add(const Scan& scan, const std::optional<Pose2>& odometry) {
  constexpr std::size_t kLeastHits = 20;
  if (scan.size() < kLeastHits || scan.hit_count() < kLeastHits) return {};
  if (scans_.empty()) {
    begin(scan, odometry);
    return {};
  }
  std::optional<Stop> ended;
  if (!wheels_rest(odometry) || scans_.size() >= options_.most_scans) {
    ended = end();
    begin(scan, odometry);
    return ended;
  }
  const std::vector<float> ranges = on_grid(scan, grid_);
  const SmallMotion motion = small_motion(grid_, reference_, ranges);
  const bool here = motion.agreeing >= options_.agreeing_min && std::hypot(motion.x, motion.y) < options_.still_m &&
                    std::abs(motion.theta) < deg_to_rad(options_.still_deg);
  if (here) {
    odd_ = 0;
    const auto same = [](float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); };
    const Scan& last = scans_.back();
    if (std::equal(scan.ranges.begin(), scan.ranges.end(), last.ranges.begin(), last.ranges.end(), same)) return {};
    scans_.push_back(scan);
    motions_.push_back(motion);
    return {};
  }
  if (++odd_ <= options_.odd_in_a_row && scans_.size() > 1) return {};
  ended = end();
  begin(scan, odometry);
  return ended;
}

std::optional<Stop> StopFinder::finish() {
  return scans_.empty() ? std::nullopt : end();
}

}  // namespace phasescan
