/// Transforms as they were at a time: what /tf and /tf_static said, kept for some seconds and interpolated.
#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "io/ros_messages.hpp"
#include "phasescan/core/time.hpp"
#include "ros2/messages.hpp"

namespace phasescan::ros2 {

using ros::Pose3;

Pose3 operator*(const Pose3& T_a_b, const Pose3& T_b_c);
Pose3 inverse(const Pose3& T_a_b);
/// From `a` (share 0) to `b` (share 1): straight in translation, the short way round in rotation.
Pose3 interpolate(const Pose3& a, const Pose3& b, double share);

/// What a lookup came to.
enum class TransformFound {
  kFound,
  kUnknownFrame,  ///< no transform ever named one of the frames
  kNotConnected,  ///< both are known, and nothing leads from one to the other
  kTooEarly,      ///< the time lies before all that is kept of a transform on the way
  kTooLate,       ///< not there yet: the time lies behind the newest transform on the way
};
const char* text_of(TransformFound found);

struct TransformLookup {
  TransformFound found = TransformFound::kUnknownFrame;
  Pose3 pose;         ///< T_target_source
  std::string where;  ///< the frame on the way that is missing or whose transform does not reach the time
};

/// Keeps at most 1024 frames and 4096 transforms of each, whatever comes.
class TransformBuffer {
 public:
  /// @param kept  how long back, counted from each frame's newest transform
  explicit TransformBuffer(Stamp kept = 10'000'000'000) : kept_(kept) {}

  /// Transforms of a message. One that is older than its newest is put where it belongs, unless it is older by more
  /// than `kJump`: then the clock was set back and what is kept of that frame is forgotten. One of the same stamp takes
  /// the other's place. What is not finite, has a quaternion that is none, or leads to itself is left out.
  /// @return how many were left out
  std::size_t add(const TFMessage& message, bool is_static);

  /// T_target_source at `stamp`: interpolated between the neighbours in time, never beyond the newest.
  TransformLookup find(std::string_view target, std::string_view source, Stamp stamp) const;
  /// The newest that is known, each step of the way by itself.
  TransformLookup find_newest(std::string_view target, std::string_view source) const;
  /// The stamp of the newest transform of a frame to its parent; nothing for static and unknown ones.
  std::optional<Stamp> newest(std::string_view child) const;
  bool is_known(std::string_view frame) const;

  /// Forgets what is later: the clock was set back. Static transforms stay.
  void forget_after(Stamp stamp);

  static constexpr Stamp kJump = 1'000'000'000;

 private:
  struct Edge {
    std::string parent;
    bool is_static = false;
    std::deque<std::pair<Stamp, Pose3>> poses;  // by stamp, the oldest first
  };
  bool add_one(const TransformStamped& transform, bool is_static);
  TransformFound at(const Edge& edge, std::optional<Stamp> stamp, Pose3& out) const;
  TransformLookup look_up(std::string_view target, std::string_view source, std::optional<Stamp> stamp) const;

  Stamp kept_;
  std::map<std::string, Edge, std::less<>> edges_;
};

}  // namespace phasescan::ros2
