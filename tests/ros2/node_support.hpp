// Messages for tests, and a node's outputs kept.
#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "core/random.hpp"
#include "ros2/codec.hpp"
#include "ros2/convert.hpp"
#include "ros2/outputs.hpp"
#include "support/toy_world.hpp"

namespace phasescan::ros2 {

constexpr Stamp kSecond = 1'000'000'000;

inline Stamp at(double seconds) {
  return 1'700'000'000 * kSecond + stamp_from_seconds(seconds);
}

/// What a visitor fills with numbers that are all different, so that two exchanged fields are seen.
class Filler {
 public:
  explicit Filler(std::uint64_t seed) : random_(seed) {}
  void time(std::string_view, Stamp& value) { value = static_cast<Stamp>(random_.below(2'000'000'000'000'000'000ULL)); }
  template <class T>
  void operator()(std::string_view, T& value) {
    if constexpr (std::is_floating_point_v<T>) {
      value = static_cast<T>(random_.normal(0.0, 1e3));
    } else if constexpr (std::is_integral_v<T>) {
      value = static_cast<T>(random_.bits());
    } else if constexpr (std::is_same_v<T, std::string>) {
      value.clear();
      for (auto n = random_.below(9); n > 0; --n) value += static_cast<char>('a' + random_.below(26));
    } else if constexpr (std::is_same_v<T, Covariance6>) {
      for (double& element : value) element = random_.normal();
    } else if constexpr (requires { value.push_back({}); }) {
      value.resize(random_.below(6));
      for (auto& element : value) (*this)("", element);
    } else {
      Message<T>::visit(value, *this);
    }
  }

 private:
  Random random_;
};

template <class M>
M random_message(std::uint64_t seed) {
  M message;
  Message<M>::visit(message, Filler(seed));
  return message;
}

inline LaserScan toy_message(const Pose2& T_world_laser, Stamp stamp, Random& random,
                             const std::string& frame = "laser", bool flipped = false) {
  testing::ToyLidar lidar;
  return ros::from_scan(testing::toy_scan(testing::two_rooms(), T_world_laser, lidar, random, stamp, {}, flipped),
                        frame, 0.1);
}

inline TFMessage tf_message(Stamp stamp, const std::string& parent, const std::string& child, const Pose2& pose) {
  return {{to_transform(stamp, parent, child, pose)}};
}

struct KeptOutputs : NodeOutputs {
  void transforms(const TFMessage& m) override {
    for (const TransformStamped& t : m.transforms) transform_list.push_back(t);
  }
  void pose(const PoseWithCovarianceStamped& m) override { poses.push_back(m); }
  void map(const OccupancyGrid& m) override {
    const std::lock_guard lock(mutex);
    maps.push_back(m);
  }
  void path(const Path& m) override { paths.push_back(m); }
  void particles(const ParticleCloud& m) override { clouds.push_back(m); }
  void status(const String& m) override { states.push_back(m.data); }
  void diagnostics(const DiagnosticArray& m) override { reports.push_back(m); }

  /// Of one child frame.
  std::vector<TransformStamped> of(const std::string& child) const {
    std::vector<TransformStamped> out;
    for (const TransformStamped& t : transform_list) {
      if (t.child_frame_id == child) out.push_back(t);
    }
    return out;
  }
  /// All of it as bytes.
  std::vector<std::uint8_t> bytes() const {
    std::vector<std::uint8_t> out;
    const auto add = [&](const auto& messages) {
      for (const auto& message : messages) {
        const auto more = encode(message);
        out.insert(out.end(), more.begin(), more.end());
      }
    };
    add(std::vector<TFMessage>{{transform_list}}), add(poses), add(maps), add(paths), add(clouds);
    return out;
  }

  std::mutex mutex;
  std::vector<TransformStamped> transform_list;
  std::vector<PoseWithCovarianceStamped> poses;
  std::vector<OccupancyGrid> maps;
  std::vector<Path> paths;
  std::vector<ParticleCloud> clouds;
  std::vector<std::string> states;
  std::vector<DiagnosticArray> reports;
};

inline Pose2 pose_of(const TransformStamped& t) {
  return to_pose2({{t.transform.translation.x, t.transform.translation.y, 0.0}, t.transform.rotation});
}

}  // namespace phasescan::ros2
