#include "io/ros_messages.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "io/cdr.hpp"
#include "io/ros_tf.hpp"

namespace phasescan::ros {
namespace {

/// ROS 1: values follow one another, headers begin with a sequence number, strings have no NUL.
class Ros1Wire {
 public:
  explicit Ros1Wire(Bytes data) : reader_(data) {}

  template <class T>
  T get() {
    return reader_.get<T>();
  }
  std::string_view text() { return reader_.prefixed_text(); }
  void floats(std::vector<float>& out) {
    const auto n = get<std::uint32_t>();
    const Bytes raw = reader_.bytes(std::uint64_t{n} * sizeof(float));
    out.resize(n);
    if (n > 0) std::memcpy(out.data(), raw.data(), raw.size());
  }
  void begin_header() { get<std::uint32_t>(); }
  Stamp seconds() { return get<std::uint32_t>(); }
  void skip_doubles(int n) { reader_.bytes(static_cast<std::uint64_t>(n) * sizeof(double)); }
  void finish() const {
    if (reader_.remaining() > 0) throw DecodeError(std::to_string(reader_.remaining()) + " bytes too many");
  }

 private:
  ByteReader reader_;
};

class CdrWire : public CdrInput {
 public:
  using CdrInput::CdrInput;
  void floats(std::vector<float>& out) { sequence(out); }
  void begin_header() {}
  Stamp seconds() { return get<std::int32_t>(); }
  void finish() const {}  // writers pad the end as they like
};

template <class W>
void read_header(W& wire, Header& out) {
  wire.begin_header();
  const Stamp seconds = wire.seconds();
  out.stamp = seconds * 1'000'000'000 + static_cast<Stamp>(wire.template get<std::uint32_t>());
  out.frame_id = wire.text();
}

template <class W>
Pose3 read_pose(W& wire) {
  Pose3 pose;
  for (int i = 0; i < 3; ++i) pose.translation[i] = wire.template get<double>();
  Eigen::Quaterniond& q = pose.rotation;
  q.x() = wire.template get<double>();
  q.y() = wire.template get<double>();
  q.z() = wire.template get<double>();
  q.w() = wire.template get<double>();
  const double norm = q.norm();
  if (!pose.translation.allFinite() || !std::isfinite(norm)) throw DecodeError("a pose that is not finite");
  if (norm > 0.0) {
    q.coeffs() /= norm;
  } else {
    q.setIdentity();
  }
  return pose;
}

template <class W>
void read_limits(W& wire, LaserScan& out) {
  for (float* value : {&out.angle_min, &out.angle_max, &out.angle_increment, &out.time_increment, &out.scan_time,
                       &out.range_min, &out.range_max}) {
    *value = wire.template get<float>();
  }
}

template <class W>
void read(W wire, LaserScan& out) {
  read_header(wire, out.header);
  read_limits(wire, out);
  wire.floats(out.ranges);
  wire.floats(out.intensities);
  wire.finish();
}

/// An array of echoes for each beam: the first of them, NaN for a beam without.
template <class W>
void read_first_echoes(W& wire, std::vector<float>& out) {
  std::vector<float> echoes;
  out.clear();
  for (auto n = wire.template get<std::uint32_t>(); n > 0; --n) {
    wire.floats(echoes);
    out.push_back(echoes.empty() ? std::numeric_limits<float>::quiet_NaN() : echoes.front());
  }
}

template <class W>
void read_multi_echo(W wire, LaserScan& out) {
  read_header(wire, out.header);
  read_limits(wire, out);
  read_first_echoes(wire, out.ranges);
  read_first_echoes(wire, out.intensities);
  wire.finish();
}

template <class W>
void read(W wire, Odometry& out) {
  read_header(wire, out.header);
  out.child_frame_id = wire.text();
  out.pose = read_pose(wire);
  wire.skip_doubles(36 + 6 + 36);
  wire.finish();
}

template <class W>
void read(W wire, std::vector<Transform>& out) {
  out.clear();
  for (auto n = wire.template get<std::uint32_t>(); n > 0; --n) {
    Transform transform;
    read_header(wire, transform.header);
    transform.child_frame_id = wire.text();
    transform.pose = read_pose(wire);
    out.push_back(std::move(transform));
  }
  wire.finish();
}

template <class W>
void read(W wire, PoseEstimate& out) {
  read_header(wire, out.header);
  out.pose = planar(read_pose(wire));
  double full[36];
  for (double& value : full) value = wire.template get<double>();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) out.covariance(row, column) = full[kPlanar[row] * 6 + kPlanar[column]];
  }
  wire.finish();
}

template <class T>
void decode_any(Wire wire, Bytes data, T& out) {
  if (wire == Wire::kRos1) {
    read(Ros1Wire(data), out);
  } else {
    read(CdrWire(data), out);
  }
}

constexpr double kLongestTurnSeconds = 2.0;

}  // namespace

void decode(Wire wire, Bytes data, LaserScan& out) {
  decode_any(wire, data, out);
}
void decode_multi_echo(Wire wire, Bytes data, LaserScan& out) {
  if (wire == Wire::kRos1) {
    read_multi_echo(Ros1Wire(data), out);
  } else {
    read_multi_echo(CdrWire(data), out);
  }
}
void decode(Wire wire, Bytes data, Odometry& out) {
  decode_any(wire, data, out);
}
void decode(Wire wire, Bytes data, std::vector<Transform>& out) {
  decode_any(wire, data, out);
}

void decode(Wire wire, Bytes data, PoseEstimate& out) {
  decode_any(wire, data, out);
}

Scan to_scan(const LaserScan& message, const ScanUnits& units) {
  ScanGeometry geometry;
  geometry.angle_min = units.angle * message.angle_min;
  geometry.angle_increment = units.angle * message.angle_increment;
  geometry.range_min = units.range * message.range_min;
  geometry.range_max = units.range * message.range_max;
  const std::size_t n = message.ranges.size();
  const bool stated = std::isfinite(message.angle_increment) && message.angle_increment != 0.0F;
  if (n > 1 && (!stated || units.increment_from_ends)) {
    geometry.angle_increment =
        units.angle * (double{message.angle_max} - double{message.angle_min}) / static_cast<double>(n - 1);
  }
  std::vector<float> scaled;
  if (units.range != 1.0) {
    scaled = message.ranges;
    for (float& range : scaled) range = static_cast<float>(units.range * range);
  }
  Scan scan;
  try {
    scan = make_scan(scaled.empty() ? message.ranges : scaled, geometry);
  } catch (const std::invalid_argument& error) {
    throw DecodeError(error.what());
  }
  scan.stamp = message.header.stamp;
  const double turn_seconds = double{message.time_increment} * static_cast<double>(n);
  if (turn_seconds >= 0.0 && turn_seconds <= kLongestTurnSeconds) scan.time_increment = message.time_increment;
  if (message.intensities.size() == n) scan.intensities = message.intensities;
  for (float& value : scan.intensities) value = std::isfinite(value) ? value : 0.0F;
  return scan;
}

LaserScan from_scan(const Scan& scan, const std::string& frame_id, double scan_time) {
  const std::size_t n = scan.size();
  double first = scan.geometry.angle_min;
  double step = scan.geometry.angle_increment;
  if (!scan.angles.empty()) {
    first = scan.angle(0);
    step = n > 1 ? (scan.angle(n - 1) - first) / static_cast<double>(n - 1) : 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      if (std::abs(scan.angle(i) - (first + static_cast<double>(i) * step)) > std::abs(step) / 2.0) {
        throw std::invalid_argument("scan.angles: a LaserScan has beams at even angles only");
      }
    }
  }
  LaserScan message;
  message.header = {scan.stamp, frame_id};
  message.angle_min = static_cast<float>(first);
  message.angle_increment = static_cast<float>(step);
  message.angle_max = static_cast<float>(n > 1 ? first + static_cast<double>(n - 1) * step : first);
  message.time_increment = static_cast<float>(scan.time_increment);
  message.scan_time = static_cast<float>(scan_time);
  message.range_min = static_cast<float>(scan.geometry.range_min);
  message.range_max = static_cast<float>(scan.geometry.range_max);
  message.ranges.resize(n);
  for (std::size_t i = 0; i < n; ++i) message.ranges[i] = raw_range(scan, i);
  message.intensities = scan.intensities;
  return message;
}

}  // namespace phasescan::ros
