#include "phasescan/slam/slam.hpp"

#include <algorithm>
#include <cmath>
#include <future>
#include <span>

#include "core/motion.hpp"
#include "slam/trajectory_refinement.hpp"

namespace phasescan {

/// The backend's thread, if there is one: at most one batch is in work.
struct Slam::Worker {
  std::future<void> running;
  /// Until the batch is done; what went wrong in it is thrown by get().
  void wait() const {
    if (running.valid()) running.wait();
  }
  void get() {
    if (running.valid()) running.get();
  }
};

Slam::Slam(const SlamOptions& options, int threads)
    : options_(options),
      threads_(threads),
      tracker_(options.odometry),
      backend_(std::make_unique<Backend>(options)),
      worker_(std::make_unique<Worker>()) {
  options_.validate();
}

Slam::~Slam() {
  worker_->wait();
}

const Backend& Slam::backend() const {
  worker_->wait();
  return *backend_;
}

TrackerStep Slam::add(const RangeMeasurement& measurement) {
  const Scan& scan = measurement.scan;
  backend_cpu_s_ = 0.0;
  TrackerStep step = tracker_.add(measurement);
  std::shared_ptr<const StoredScan> stored;
  if (!options_.slam.bounded_memory && (step.keyframe || options_.slam.polish))
    stored = store_.stored(store_.add(scan, measurement.T_base_laser));
  if (step.keyframe) {
    if (step.diagnostics.new_segment) breaks_.push_back(keyframes_);
    std::shared_ptr<const Scan> own;
    if (options_.slam.bounded_memory) own = std::make_shared<const Scan>(scan);
    keyframe_scans_.push_back({static_cast<std::int64_t>(records_.size()), std::move(stored), std::move(own)});
    T_odom_keyframe_ = step.T_odom_mid;
    ++keyframes_;
  }
  take(std::move(step.keyframes));
  const Pose2 relative = T_odom_keyframe_.inverse() * step.T_odom_stamp;
  records_.push_back({scan.stamp, keyframes_ - 1, static_cast<float>(relative.x), static_cast<float>(relative.y),
                      static_cast<float>(relative.theta)});
  if (batch_.size() >= static_cast<std::size_t>(options_.slam.batch_nodes)) hand_over();
  return step;
}

void Slam::take(std::vector<TrackedKeyframe> keyframes) {
  for (TrackedKeyframe& tracked : keyframes) {
    Keyframe keyframe;
    keyframe.points = std::move(tracked.points);
    keyframe.T_odom_base = tracked.T_odom_base;
    keyframe.information = tracked.information;
    keyframe.new_segment = tracked.new_segment;
    keyframe.laser = std::move(tracked.laser);
    keyframe.T_base_laser = tracked.T_base_laser;
    keyframe.twist = tracked.twist;
    keyframe.T_mid_stamp = tracked.T_mid_stamp;
    keyframe.scan = keyframe_scans_.front().scan;
    keyframe.stored = std::move(keyframe_scans_.front().stored);
    keyframe.own_scan = std::move(keyframe_scans_.front().own);
    keyframe_scans_.pop_front();
    const MapPoints& points = *keyframe.points;
    for (std::size_t i = 0; i < points.size(); ++i) keyframe.centre += Eigen::Vector2d(points.x[i], points.y[i]);
    if (points.size() > 0) keyframe.centre /= static_cast<double>(points.size());
    // The first one comes with the second scan, and stands elsewhere than its own scan's answer said: it was deskewed.
    T_odom_keyframe_ = keyframe.T_odom_base;
    for (auto r = records_.begin() + std::min<std::int64_t>(keyframe.scan, std::ssize(records_)); r != records_.end();
         ++r) {
      r->x = static_cast<float>(keyframe.T_mid_stamp.x);
      r->y = static_cast<float>(keyframe.T_mid_stamp.y);
      r->theta = static_cast<float>(keyframe.T_mid_stamp.theta);
    }
    batch_.push_back(std::move(keyframe));
  }
}

void Slam::repeat(const RangeMeasurement& measurement) {
  backend_cpu_s_ = 0.0;
  records_.push_back(records_.empty() ? ScanRecord{} : records_.back());
  records_.back().stamp = measurement.scan.stamp;
  if (options_.slam.polish && !options_.slam.bounded_memory) store_.add(measurement.scan, measurement.T_base_laser);
}

void Slam::hand_over() {
  const double before = thread_cpu_seconds();
  worker_->get();
  std::vector<Keyframe> batch;
  batch.swap(batch_);
  if (threads_ > 1) {
    worker_->running = std::async(
        std::launch::async, [this, batch = std::move(batch)]() mutable { backend_->add_batch(std::move(batch)); });
  } else {
    backend_->add_batch(std::move(batch));
  }
  backend_cpu_s_ = thread_cpu_seconds() - before;
}

void Slam::finish() {
  take(tracker_.finish());
  if (!batch_.empty()) hand_over();
  worker_->get();
  backend_->finish();
  if (options_.slam.polish && !options_.slam.bounded_memory && !records_.empty()) {
    polished_ = refine_trajectory(*backend_, store_, trajectory(), records_, options_.odometry);
  }
}

std::vector<Pose2> Slam::trajectory() const {
  if (!records_.empty() && polished_.size() == records_.size()) return polished_;
  return anchored(backend().submitted_poses());
}

std::optional<Pose2> Slam::pose_on_map(std::size_t scan) const {
  const ScanRecord& r = records_.at(scan);
  if (r.keyframe < 0 || static_cast<std::size_t>(r.keyframe) >= backend().submitted()) return std::nullopt;
  return backend().submitted_pose(static_cast<std::size_t>(r.keyframe)) *
         Pose2{static_cast<double>(r.x), static_cast<double>(r.y), static_cast<double>(r.theta)};
}

PlacedScan Slam::placed_keyframe(std::size_t i) const {
  const bool polished = !records_.empty() && polished_.size() == records_.size();
  const Keyframe& keyframe = backend().keyframes()[i];
  const Pose2 T_map_stamp =
      polished ? polished_[static_cast<std::size_t>(keyframe.scan)] : backend().poses()[i] * keyframe.T_mid_stamp;
  PlacedScan placed;
  placed.scan = keyframe.scan_data();
  placed.T_map_laser = T_map_stamp * keyframe.T_base_laser;
  placed.twist = options_.odometry.deskew ? twist_of_frame(keyframe.T_base_laser, keyframe.twist) : Twist2{};
  return placed;
}

std::vector<std::size_t> Slam::drawn_keyframes() const {
  std::vector<std::size_t> drawn;
  const MapPieces pieces = backend().pieces();
  for (std::size_t i = 0; i < pieces.of_node.size(); ++i) {
    if (!options_.slam.largest_piece || pieces.in_largest(i)) drawn.push_back(i);
  }
  return drawn;
}

std::vector<char> Slam::on_map() const {
  std::vector<char> on(records_.size(), 1);
  if (!options_.slam.largest_piece) return on;
  const Backend& map = backend();
  const MapPieces pieces = map.pieces();
  for (std::size_t i = 0; i < on.size(); ++i) {
    const auto k = static_cast<std::size_t>(records_[i].keyframe);
    if (records_[i].keyframe < 0 || k >= map.submitted()) continue;
    on[i] = pieces.in_largest(static_cast<std::size_t>(map.node_of(k)));
  }
  return on;
}

std::size_t Slam::scans_left_out() const {
  const std::vector<char> on = on_map();
  return static_cast<std::size_t>(std::count(on.begin(), on.end(), 0));
}

OccupancyGrid Slam::render_map() const {
  OccupancyGrid grid(options_.map);
  for (const std::size_t i : drawn_keyframes()) {
    const PlacedScan placed = placed_keyframe(i);
    grid.add_scan(placed.scan, placed.T_map_laser, placed.twist);
  }
  return grid;
}

std::vector<GlassPane> Slam::find_glass_panes(const OccupancyGrid& grid) const {
  if (!options_.glass.enabled) return {};
  const std::vector<std::size_t> drawn = drawn_keyframes();
  std::vector<GlassPane> panes = find_glass(
      drawn.size(), [&](std::size_t i) { return placed_keyframe(drawn[i]); }, grid, options_.glass);
  // Where the robot drove on this map; where pieces that are not on it lie is a guess.
  const std::vector<Pose2> poses = trajectory();
  const std::vector<char> on = on_map();
  for (auto begin = on.begin(); begin != on.end();) {
    const auto end = std::find(begin, on.end(), 0);
    const std::span<const Pose2> way(poses.begin() + (begin - on.begin()), poses.begin() + (end - on.begin()));
    panes = cut_where_driven(std::move(panes), way, options_.glass.keep_open_m, options_.glass.min_length_m);
    begin = std::find(end, on.end(), 1);
  }
  return panes;
}

std::vector<Pose2> Slam::odometry_trajectory() const {
  return anchored(backend().submitted_poses(true));
}

std::vector<Pose2> Slam::anchored(const std::vector<Pose2>& keyframe_poses) const {
  std::vector<Pose2> out;
  out.reserve(records_.size());
  const std::vector<Pose2> odometry = backend().submitted_poses(true);
  std::size_t begin = 0;
  while (begin < records_.size()) {
    const std::int32_t keyframe = records_[begin].keyframe;
    std::size_t end = begin;
    while (end < records_.size() && records_[end].keyframe == keyframe) ++end;
    const auto k = static_cast<std::size_t>(keyframe);
    const bool known = keyframe >= 0 && k < keyframe_poses.size();
    // What the map corrected between this keyframe and the next happened on the way there, not at its end.
    Twist2 correction;
    if (known && k + 1 < keyframe_poses.size() && !std::binary_search(breaks_.begin(), breaks_.end(), keyframe + 1)) {
      const Pose2 on_map = keyframe_poses[k].inverse() * keyframe_poses[k + 1];
      correction = log_pose((odometry[k].inverse() * odometry[k + 1]).inverse() * on_map);
    }
    for (std::size_t i = begin; i < end; ++i) {
      const ScanRecord& r = records_[i];
      const Pose2 T_keyframe_stamp{static_cast<double>(r.x), static_cast<double>(r.y), static_cast<double>(r.theta)};
      const double share = static_cast<double>(i - begin) / static_cast<double>(end - begin);
      const Pose2 part = exp_twist(correction, share);
      out.push_back(known ? keyframe_poses[k] * T_keyframe_stamp * part : T_keyframe_stamp);
    }
    begin = end;
  }
  return out;
}

}  // namespace phasescan
