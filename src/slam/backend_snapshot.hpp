/// The map as it stood after a batch: immutable, shared, never waited for.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "map/occupancy_grid.hpp"
#include "phasescan/core/pose2.hpp"
#include "phasescan/map/trinary_map.hpp"
#include "slam/connectivity.hpp"
#include "slam/keyframe.hpp"

namespace phasescan {

/// What of a node is needed to draw its scan. Scans are shared, not copied.
struct SnapshotNode {
  std::shared_ptr<const StoredScan> stored;
  std::shared_ptr<const Scan> own_scan;
  std::int64_t id = 0;  ///< number of the scan in the run
  Pose2 T_mid_stamp;    ///< the base at the scan's first beam, seen from mid-scan
  Pose2 T_base_laser;
  Twist2 twist;  ///< of the base during the turn

  Scan scan() const { return own_scan ? *own_scan : stored ? stored->scan() : Scan{}; }
};

SnapshotNode node_of(const Keyframe& keyframe);

/// Nodes in order, in blocks that all snapshots share but for the last.
class SnapshotNodes {
 public:
  std::size_t size() const { return size_; }
  const SnapshotNode& operator[](std::size_t i) const { return (*blocks_[i / kBlock])[i % kBlock]; }
  /// @cost at most a block is copied
  void push_back(SnapshotNode node);

 private:
  static constexpr std::size_t kBlock = 64;
  std::vector<std::shared_ptr<const std::vector<SnapshotNode>>> blocks_;
  std::size_t size_ = 0;
};

struct SnapshotLoop {
  std::int32_t from = 0, to = 0;
  bool enabled = true;  ///< false: undone
};

struct BackendSnapshot {
  std::uint64_t version = 0;        ///< batches that were worked on
  std::uint64_t optimisations = 0;  ///< as long as it is the same no pose of a node changes
  SnapshotNodes nodes;
  std::vector<Pose2> poses;  ///< T_map_base of each node at mid-scan
  std::vector<SnapshotLoop> loops;
  MapPieces pieces;
  std::size_t submitted = 0;  ///< keyframes that were submitted; in bounded memory not all became nodes
  int last_piece = 0;         ///< of the keyframe submitted last
  int last_session = 0;       ///< the same
  Pose2 T_map_odom;           ///< by the keyframe submitted last
  /// Of (x, y, theta) of the keyframe submitted last, in the frame of the map, relative to the first node of its piece.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// Draws snapshots. One object per viewer: it keeps its grid, and where no pose changed since the last snapshot it
/// draws new nodes alone.
class SnapshotRenderer {
 public:
  /// @param deskew         scans are drawn with the motion during their turn
  /// @param largest_piece  other pieces, of which nobody knows where they lie, are left out
  /// @param tolerance_m    poses that moved by less are drawn where they were; 0: all is drawn anew after each
  ///                       optimisation, and the answer is that of a new renderer
  SnapshotRenderer(const OccupancyOptions& options, bool deskew, bool largest_piece, double tolerance_m = 0.0)
      : grid_(options), deskew_(deskew), largest_piece_(largest_piece), tolerance_m_(tolerance_m) {}

  /// The snapshots come in the order of their versions. @cost 0.2 ms a scan that is drawn
  const OccupancyGrid& draw(const BackendSnapshot& snapshot);
  TrinaryMap map(const BackendSnapshot& snapshot) { return make_trinary(draw(snapshot)); }

 private:
  bool is_drawn_as(const BackendSnapshot& snapshot) const;

  OccupancyGrid grid_;
  bool deskew_, largest_piece_;
  double tolerance_m_;
  struct Drawn {
    std::size_t node = 0;
    Pose2 T_map_base;
  };
  std::vector<Drawn> drawn_;
};

}  // namespace phasescan
