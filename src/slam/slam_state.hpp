/// A run of SLAM as a value.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "odometry/checked_tracker.hpp"
#include "odometry/own_body.hpp"
#include "odometry/state.hpp"
#include "phasescan/slam/slam.hpp"
#include "slam/backend_runner.hpp"
#include "slam/input_check.hpp"
#include "slam/old_path.hpp"
#include "slam/scan_ledger.hpp"
#include "slam/scan_store.hpp"
#include "state/fields.hpp"

namespace phasescan {

/// A measurement's scan as keyframes have it: in the store, or by itself in bounded-memory mode.
struct KeptScan {
  ScanId scan = 0;
  std::shared_ptr<const StoredScan> stored;
  std::shared_ptr<const Scan> own;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("scan", self.scan);
    v("stored", self.stored);
    v("own", self.own);
  }
};

struct HeldMeasurement {
  RangeMeasurement measurement;
  bool repeated = false;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("measurement", self.measurement);
    v("repeated", self.repeated);
  }
};

/// What earlier sessions leave to be told at the end.
struct EarlierSessions {
  WheelCounts wheels;
  bool deskewing_refuted = false;

  void add(const EarlierSessions& more) {
    wheels.steps += more.wheels.steps;
    wheels.agreed += more.wheels.agreed;
    wheels.reversed += more.wheels.reversed;
    wheels.slipped += more.wheels.slipped;
    wheels.jumped += more.wheels.jumped;
    wheels.wheels_m += more.wheels.wheels_m;
    wheels.scans_m += more.wheels.scans_m;
    deskewing_refuted = deskewing_refuted || more.deskewing_refuted;
  }
  void add(const OdometryState& end) { add(EarlierSessions{end.motion.wheels.counts, end.deskew_test.refuted()}); }

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("wheels", self.wheels);
    v("deskewing_refuted", self.deskewing_refuted);
  }
};

/// All that is needed to go on with the same bytes; caches (local maps, indices, matchers) are made anew.
struct SlamState::Data {
  static constexpr int kVersion = 1;
  OdometryState odometry;
  SuspectState suspects;
  std::vector<ScanId> suspect_ids;         ///< of the scans in it
  std::map<LaserId, OwnBodyState> bodies;  ///< the robot in the view of each laser
  /// The measurements so far, until that is decided: where a body is found the run begins anew without it. Empty once
  /// it is decided, or where there came too many.
  std::vector<HeldMeasurement> beginning;
  BackendState backend;  ///< after the batch that was in work
  InputCheckState input;
  OldPath old;  ///< where the path is thinned: the ledger goes on after it; empty in what is saved
  ScanLedger ledger;
  ScanStore store;
  std::vector<Keyframe> batch;  ///< keyframes that wait to be handed over
  ScanUpdate last;
  Pose2 T_odom_keyframe;                                          ///< of the newest keyframe, at mid-scan
  Eigen::Matrix3d keyframe_covariance = Eigen::Matrix3d::Zero();  ///< of its pose in odom
  std::optional<KeptScan> first;                 ///< the first tracked scan, while its keyframe waits for the next one
  std::shared_ptr<const BackendResult> entered;  ///< what the tracker's side sees of the map; null before the first
  std::shared_ptr<const BackendResult> pending;  ///< the result of the last batch, which has not entered yet
  EarlierSessions earlier;
  std::int32_t session_keyframe = 0;  ///< keyframes before this session
  std::int32_t frame_session = 0;     ///< the drive whose map is in the frame it began with
  /// All as it was when this session began, while it may begin anew; null in the first session.
  std::shared_ptr<const Data> session_start;

  /// Calls v(section, fields) for each section of a file; fields(visitor) names what is in it.
  template <class Self, class Visitor>
  static void visit_sections(Self& self, Visitor&& v) {
    v("scans", [&self](auto& to) { to("store", self.store); });
    v("ledger", [&self](auto& to) { to("ledger", self.ledger); });
    v("map", [&self](auto& to) { to("backend", self.backend); });
    v("tracking", [&self](auto& to) { visit_tracking(self, to); });
  }
  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    visit_sections(self, [&v](const char*, const auto& fields) { fields(v); });
  }
  template <class Self, class Visitor>
  static void visit_tracking(Self& self, Visitor&& v) {
    v("odometry", self.odometry);
    v("suspects", self.suspects);
    v("suspect_ids", self.suspect_ids);
    v("bodies", self.bodies);
    v("beginning", self.beginning);
    v("input", self.input);
    v("batch", self.batch);
    v("last", self.last);
    v("T_odom_keyframe", self.T_odom_keyframe);
    v("keyframe_covariance", self.keyframe_covariance);
    v("first", self.first);
    v("entered", self.entered);
    v("pending", self.pending);
    v("earlier", self.earlier);
    v("session_keyframe", self.session_keyframe);
    v("session_start", self.session_start);
    visit_since(v, 2, "frame_session", self.frame_session);
  }
};

}  // namespace phasescan
