// SLAM behind the door of `live`: what happens beside the scans is handed out with the scan that brought it.
#include <algorithm>
#include <optional>
#include <set>
#include <stdexcept>

#include "phasescan/live/live.hpp"

namespace phasescan::live {
namespace {

class SlamEngine final : public LiveEngine, private SlamObserver {
 public:
  SlamEngine(Slam& slam, std::function<Slam()> renew) : slam_(slam), renew_(std::move(renew)) {
    slam_.set_observer(this);
  }
  ~SlamEngine() override { slam_.set_observer(nullptr); }

  LiveUpdate add(std::shared_ptr<const RangeMeasurement> measurement) override {
    LiveUpdate out;
    out.update = slam_.add(*measurement);
    out.measurement = std::move(measurement);
    out.confidence = is_tracked(out.update.status) ? out.update.diagnostics.overlap : 0.0;
    if (!map_ || map_->version() != out.update.map_version) {
      map_ = slam_.map();
      if (unplaced_ && is_placed()) unplaced_.reset();
    }
    out.map = map_;
    out.on_map = !unplaced_;
    if (unplaced_) show_unplaced(out.update);
    out.loops.swap(loops_);
    out.warnings.swap(warnings_);
    return out;
  }

  std::string set_pose(const Pose2& T_map_base) override {
    if (!T_map_base.is_finite()) throw std::invalid_argument("pose: not finite");
    begin_anew(T_map_base);
    return "it goes on from there; the map is joined where a place is known again";
  }

  std::string relocalise() override {
    begin_anew(std::nullopt);
    return "it looks for itself; drive on: the map is joined where a place is known again";
  }

  void restart() override {
    slam_.set_observer(nullptr);
    slam_ = renew_();
    slam_.set_observer(this);
    map_.reset();
    unplaced_.reset();
    loops_.clear();
    warnings_.clear();
  }

 private:
  void on_loop(const MapEdge& edge, bool accepted) override { loops_.push_back({edge.from, edge.to, accepted}); }
  void on_warning(ScanId, const std::string& kind, const std::string& what, bool) override {
    warnings_.push_back(kind + ": " + what);
  }

  /// A drive that nothing ties to the map before it.
  struct Unplaced {
    ScanId since = 0;
    std::optional<Pose2> told;  // T_map_odom, as a person says
  };

  void begin_anew(const std::optional<Pose2>& told) {
    if (slam_.scans() == 0) return;
    unplaced_ = {static_cast<ScanId>(slam_.scans()), told};
    slam_.begin_session();
  }

  /// Whether a keyframe of the drive hangs together with one from before it, or there was none.
  bool is_placed() const {
    std::set<std::int32_t> before;
    const std::vector<MapKeyframe> keyframes = map_->keyframes();
    for (const MapKeyframe& keyframe : keyframes)
      if (keyframe.scan < unplaced_->since) before.insert(keyframe.piece);
    return std::any_of(keyframes.begin(), keyframes.end(), [&](const MapKeyframe& keyframe) {
      return keyframe.scan >= unplaced_->since && (before.empty() || before.count(keyframe.piece) > 0);
    });
  }

  /// Its poses are those of the map only as far as somebody told where it began.
  void show_unplaced(ScanUpdate& update) const {
    constexpr double kToldM = 0.5, kToldRad = 0.2;  // how well a person points
    update.T_map_odom = unplaced_->told.value_or(Pose2{});
    update.map_covariance = update.odom_covariance;
    const double metres = unplaced_->told ? kToldM : kNowhereM, radians = unplaced_->told ? kToldRad : kPi;
    update.map_covariance->diagonal() += Eigen::Vector3d(metres * metres, metres * metres, radians * radians);
    if (!is_tracked(update.status)) return;
    update.status = unplaced_->told ? TrackingStatus::kDegraded : TrackingStatus::kLost;
  }

  static constexpr double kNowhereM = 1000.0;
  Slam& slam_;
  std::function<Slam()> renew_;
  std::shared_ptr<const MapSnapshot> map_;
  std::optional<Unplaced> unplaced_;
  std::vector<LiveLoop> loops_;
  std::vector<std::string> warnings_;
};

}  // namespace

std::unique_ptr<LiveEngine> slam_engine(Slam& slam, std::function<Slam()> renew) {
  return std::make_unique<SlamEngine>(slam, std::move(renew));
}

}  // namespace phasescan::live
