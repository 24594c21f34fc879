// The part of the tracker that finds a scan's pose: near the prediction, around it, and by the full search.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "odometry/information.hpp"
#include "phasescan/odometry/odometry.hpp"
#include "odometry/slide.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kFinalPoints = 150;  // points that judge a finished match
constexpr double kMinFinalShare = 0.85;    // a match that explains less than this of what is usual is doubted
constexpr double kFallShare = 0.7;         // one that explains less than this even after a look around asks for help
constexpr double kDoubtfulOverlap = 0.6;   // what a search in doubt must explain of the scan to be believed
constexpr double kMostDoubtfulTurn = 1.2;  // [rad] that a search in doubt may be off the motion before
constexpr double kHardlyWorse = 0.05;    // where scans jump, the full search is believed if it explains so little less
constexpr double kClearlyBetter = 0.04;  // by so much of its score another pose must be better to be taken instead
constexpr double kMostPeople = 0.3;      // of the hits
// A small thing this near to a wall that faces as it does is a piece of it, seen through a door.
constexpr float kPartOfWallM = 0.06F, kSameWay = 0.75F;

std::size_t judging_stride(const MapPoints& points) {
  return std::max<std::size_t>(1, points.size() / kFinalPoints);
}

}  // namespace

void Odometry::choose_points() {
  points_ = std::make_shared<MapPoints>();
  const MapPoints& all = *all_points_;
  const Pose2 T = map_.T_world_map().inverse() * T_odom_mid_ * step_;
  const auto c = static_cast<float>(std::cos(T.theta)), s = static_cast<float>(std::sin(T.theta));
  const auto tx = static_cast<float>(T.x), ty = static_cast<float>(T.y);
  const auto met = [&](std::size_t i) {
    if (map_.empty()) return false;
    const float px = c * all.x[i] - s * all.y[i] + tx, py = s * all.x[i] + c * all.y[i] + ty;
    if (map_.small_thing_at(px, py)) return true;
    const float nx = c * all.nx[i] - s * all.ny[i], ny = s * all.nx[i] + c * all.ny[i];
    const Surfel* wall = all.lone(i) ? map_.find_lone(px, py) : map_.find(px, py, nx, ny, kSameWay);
    return wall && std::hypot(px - wall->x, py - wall->y) < kPartOfWallM;
  };
  chosen_.clear();
  left_out_.clear();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!all.small[i] || met(i)) {
      chosen_.push_back(i);
    } else {
      left_out_.push_back(beams_[i]);
    }
  }
  points_->reserve(chosen_.size());
  for (const std::size_t i : chosen_) points_->append(all, i);
}

RangeMeasurement Odometry::without_people(const RangeMeasurement& measurement) const {
  RangeMeasurement left = measurement;
  // Where small things are much of what there is, they are furniture.
  if (static_cast<double>(left_out_.size()) > kMostPeople * static_cast<double>(all_points_->size())) return left;
  for (const int beam : left_out_) {
    const auto i = static_cast<std::size_t>(beam);
    left.scan.ranges[i] = std::numeric_limits<float>::quiet_NaN();
    left.scan.states[i] = BeamState::kInvalid;
  }
  return left;
}

std::optional<Odometry::LastScanWitness> Odometry::ask_last_scan(const RangeMeasurement& measurement,
                                                                 const Twist2& twist, const Pose2& T_stamp_mid) {
  const std::optional<ScanToScan::Found> found = last_scan_.find(without_people(measurement), twist);
  if (!found) return std::nullopt;
  const Pose2& T_odom_map = map_.T_world_map();
  return LastScanWitness{T_odom_map.inverse() * (found->T_odom_base * T_stamp_mid),
                         rotate_information(found->covariance, -T_odom_map.theta), found->usable, found->certain};
}

Registration Odometry::match(const std::optional<LastScanWitness>& last, const Pose2& guess, double periods,
                             PosePrior& prior, OdometryStep& step) {
  const bool heard = last && last->certain && !steadiness_.jumps();
  if (heard) prior = hear_last_scan(prior, *last);
  Registration found = register_points(map_, *points_, guess, {}, prior);
  // It looks no farther than scans that follow each other closely can be apart.
  if (!steadiness_.jumps()) slide_unseen(prior, found);
  if (!heard)
    assume_habit(prior.T_map_base.theta - (map_.T_world_map().inverse() * T_odom_mid_).theta, periods, prior, found);
  double score = pose_score(map_, *points_, found.T_map_base, judging_stride(*points_));
  if (steadiness_.jumps()) catch_fall(last, prior, found, score, step);
  if (!step.caught && (found.overlap < options_.min_overlap || score < kMinFinalShare * usual_final_)) {
    step.searched = true;
    look_around(prior, found, score);
    if (found.overlap < options_.min_overlap || score < kFallShare * usual_final_)
      catch_fall(last, prior, found, score, step);
  }
  if (found.overlap >= options_.min_overlap) usual_final_ = kSlow * usual_final_ + (1.0 - kSlow) * score;
  return found;
}

void Odometry::slide_unseen(const PosePrior& prior, Registration& found) const {
  if (found.overlap < options_.min_overlap || sees_both_ways(kMatchTrust * found.information)) return;
  const Eigen::Vector3d u = least_seen(kMatchTrust * found.information).direction;
  const Slide slide = slide_along(map_, *points_, found.T_map_base, u, prior);
  Pose2& T = found.T_map_base;
  T = {T.x + slide.offset_m * u.x(), T.y + slide.offset_m * u.y(), wrap_angle(T.theta + slide.offset_m * u.z())};
  const Eigen::Vector3d along(u.x(), u.y(), 0.0);
  found.information += slide.information * along * along.transpose();
}

void Odometry::assume_habit(double turn, double periods, PosePrior& prior, Registration& found) const {
  if (!ask_habits_ || found.overlap < options_.min_overlap || sees_both_ways(kMatchTrust * found.information)) return;
  const std::optional<MotionHabits::Assumption> habit = habits_.assume(wrap_angle(turn) / periods);
  if (!habit) return;
  Eigen::Matrix3d covariance = step_covariance_;
  covariance.topLeftCorner<2, 2>() = habit->covariance;
  covariance.topRightCorner<2, 1>().setZero();
  covariance.bottomLeftCorner<1, 2>().setZero();
  prior = make_prior({periods * habit->x, periods * habit->y, wrap_angle(turn)}, covariance, periods);
  found = register_points(map_, *points_, prior.T_map_base, {}, prior);
}

void Odometry::look_around(const PosePrior& prior, Registration& found, double& score) const {
  // Not as well as scans usually lie on the map: is there a pose nearby that explains this one better?
  for (const LatticeSearch& lattice : {LatticeSearch{0.3, 0.15, 0.72, 0.08, 70}, LatticeSearch{}}) {
    const Pose2 wide = search_lattice(map_, *points_, found.T_map_base, lattice);
    PosePrior moved_prior = prior;
    moved_prior.T_map_base.theta = wide.theta;
    const Registration again = register_points(map_, *points_, wide, {}, moved_prior);
    const double again_score = pose_score(map_, *points_, again.T_map_base, judging_stride(*points_));
    if (again_score > score + kClearlyBetter) {
      found = again;
      score = again_score;
    }
    if (found.overlap >= options_.min_overlap) break;
  }
}

void Odometry::catch_fall(const std::optional<LastScanWitness>& last, PosePrior& prior, Registration& found,
                          double& score, OdometryStep& step) const {
  if (!last || (!last->usable && !steadiness_.jumps())) return;
  // The match knows more of the pose now than the motion model does.
  PosePrior by_match;
  by_match.T_map_base = last->T_map_mid;
  // A match in doubt is a place to begin at, no more.
  by_match.information = last->usable ? last->covariance.inverse() / kMatchTrust : prior.information;
  if (!by_match.information.allFinite()) return;
  if (!last->usable) {
    // One in doubt may be the twin of the right one.
    if (angle_distance(prior.T_map_base.theta, by_match.T_map_base.theta) > kMostDoubtfulTurn) return;
  }
  const Registration again = register_points(map_, *points_, by_match.T_map_base, {}, by_match);
  const double again_score = pose_score(map_, *points_, again.T_map_base, judging_stride(*points_));
  const double asked = !steadiness_.jumps() ? kClearlyBetter : last->usable ? -kHardlyWorse : 0.0;
  if (!last->usable && again.overlap < kDoubtfulOverlap) return;
  if (again_score < score + asked && !(found.overlap < options_.min_overlap && again_score >= score)) return;
  found = again;
  score = again_score;
  prior = by_match;
  step.caught = true;
}

}  // namespace phasescan
