// SLAM behind the door of `live`: what happens beside the scans is handed out with the scan that brought it.
#include <optional>
#include <stdexcept>

#include "phasescan/core/time.hpp"
#include "phasescan/live/live.hpp"
#include "slam/map_view.hpp"

namespace phasescan::live {
namespace {

class SlamEngine final : public LiveEngine, private SlamObserver {
 public:
  SlamEngine(Slam& slam, std::function<Slam()> renew, std::size_t path_scans)
      : slam_(slam), renew_(std::move(renew)), path_scans_(path_scans) {
    attend();
    if (const auto snapshot = behind(*slam_.map())) session_ = snapshot->last_session;
  }
  ~SlamEngine() override { slam_.set_observer(nullptr); }

  LiveUpdate add(std::shared_ptr<const RangeMeasurement> measurement) override {
    LiveUpdate out;
    out.update = slam_.add(*measurement);
    out.measurement = std::move(measurement);
    out.confidence = is_tracked(out.update.status) ? out.update.diagnostics.overlap : 0.0;
    note_break(out.update);
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
    attend();
    map_.reset();
    unplaced_.reset();
    session_ = 0;
    session_scans_ = 0;
    keyframes_ = 0;
    tracked_.reset();
    loops_.clear();
    warnings_.clear();
  }

 private:
  void on_loop(const MapEdge& edge, bool accepted) override { loops_.push_back({edge.from, edge.to, accepted}); }
  void on_warning(ScanId, const std::string& kind, const std::string& what, bool) override {
    warnings_.push_back(kind + ": " + what);
  }

  /// A way that nothing ties to the map before it.
  struct Unplaced {
    enum class Why { kAnew, kTold, kBroke } why = Why::kAnew;
    ScanId since = 0;               // its first scan,
    KeyframeId since_keyframe = 0;  // and keyframe
    Pose2 told;                     // T_map_odom, as a person says
    bool long_broke = false;        // so long unseen that the pose may be anywhere
  };

  /// A sensor sends for days.
  void attend() {
    slam_.set_observer(this);
    slam_.set_path_limit(path_scans_);
  }

  void begin_anew(const std::optional<Pose2>& told) {
    if (slam_.scans() == 0) return;
    if (slam_.scans() > session_scans_) ++session_;
    session_scans_ = slam_.scans();
    unplaced_ = {told ? Unplaced::Why::kTold : Unplaced::Why::kAnew, static_cast<ScanId>(slam_.scans()), keyframes_,
                 told.value_or(Pose2{})};
    slam_.begin_session();
  }

  /// Where tracking broke and began again, no more than a prediction ties the pose to the map.
  void note_break(const ScanUpdate& update) {
    constexpr double kLong_s = 1.0;
    const bool broke = update.diagnostics.new_segment && keyframes_ > 0 && tracked_;
    if (broke) {
      if (!unplaced_) unplaced_ = {Unplaced::Why::kBroke, update.scan, 0, {}, false};
      unplaced_->since_keyframe = update.keyframe.value_or(keyframes_);
      unplaced_->long_broke |= stamp_to_seconds(update.stamp - *tracked_) > kLong_s;
    }
    if (update.keyframe) keyframes_ = *update.keyframe + 1;
    if (is_tracked(update.status)) tracked_ = update.stamp;
  }

  /// Whether the newest keyframe of the way hangs together with the map: what was there before a drive that begins
  /// anew, what is drawn where tracking broke.
  bool is_placed() const {
    const auto snapshot = behind(*map_);
    if (!snapshot || snapshot->last_session < session_ ||
        static_cast<KeyframeId>(snapshot->submitted) <= unplaced_->since_keyframe)
      return false;
    if (unplaced_->why == Unplaced::Why::kBroke) return snapshot->last_piece == snapshot->pieces.largest;
    bool any_before = false;
    for (std::size_t node = 0; node < snapshot->nodes.size(); ++node) {
      if (snapshot->nodes[node].id >= unplaced_->since) continue;
      any_before = true;
      if (snapshot->pieces.of_node[node] == snapshot->last_piece) return true;
    }
    return !any_before;
  }

  /// Its poses are those of the map only as far as somebody told where it began, or as a prediction goes.
  void show_unplaced(ScanUpdate& update) const {
    constexpr double kToldM = 0.5, kToldRad = 0.2;  // how well a person points, and how far a short break leads
    const bool anew = unplaced_->why == Unplaced::Why::kAnew,
               nowhere = anew || (unplaced_->why == Unplaced::Why::kBroke && unplaced_->long_broke);
    if (unplaced_->why != Unplaced::Why::kBroke) update.T_map_odom = unplaced_->told;
    update.map_covariance = update.odom_covariance;
    const double metres = nowhere ? kNowhereM : kToldM, radians = nowhere ? kPi : kToldRad;
    update.map_covariance->diagonal() += Eigen::Vector3d(metres * metres, metres * metres, radians * radians);
    if (!is_tracked(update.status)) return;
    update.status = nowhere ? TrackingStatus::kLost : TrackingStatus::kDegraded;
  }

  static constexpr double kNowhereM = 1000.0;
  Slam& slam_;
  std::function<Slam()> renew_;
  std::size_t path_scans_ = 0;
  std::shared_ptr<const MapSnapshot> map_;
  std::optional<Unplaced> unplaced_;
  int session_ = 0;                // number of the drive
  std::size_t session_scans_ = 0;  // before it
  KeyframeId keyframes_ = 0;       // so far
  std::optional<Stamp> tracked_;   // when it was last
  std::vector<LiveLoop> loops_;
  std::vector<std::string> warnings_;
};

}  // namespace

std::unique_ptr<LiveEngine> slam_engine(Slam& slam, std::function<Slam()> renew, std::size_t path_scans) {
  return std::make_unique<SlamEngine>(slam, std::move(renew), path_scans);
}

}  // namespace phasescan::live
