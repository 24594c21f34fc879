#include "dds/fast_peer/cdr_messages.hpp"

#include <array>
#include <cmath>

namespace fast_peer {

using eprosima::fastcdr::FastBuffer;

Bytes made(const std::function<void(Cdr&)>& fill) {
  FastBuffer buffer;
  Cdr cdr(buffer, Cdr::LITTLE_ENDIANNESS, Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  fill(cdr);
  return Bytes(buffer.getBuffer(), buffer.getBuffer() + cdr.getSerializedDataLength());
}

void put_header(Cdr& cdr, std::int64_t stamp, const std::string& frame) {
  cdr << static_cast<std::int32_t>(stamp / 1'000'000'000) << static_cast<std::uint32_t>(stamp % 1'000'000'000) << frame;
}
void put_pose(Cdr& cdr, const Planar& pose) {
  cdr << pose.x << pose.y << 0.0 << 0.0 << 0.0 << std::sin(pose.theta / 2) << std::cos(pose.theta / 2);
}
Bytes tf_message(std::int64_t stamp, const std::string& parent, const std::string& child, const Planar& pose) {
  return made([&](Cdr& cdr) {
    cdr << std::uint32_t{1};
    put_header(cdr, stamp, parent);
    cdr << child;
    put_pose(cdr, pose);
  });
}

namespace {

/// Reads what stands in a message, in the order of its type.
class Taken {
 public:
  explicit Taken(Bytes& bytes)
      : buffer_(bytes.data(), bytes.size()), cdr_(buffer_, Cdr::LITTLE_ENDIANNESS, Cdr::DDS_CDR) {
    cdr_.read_encapsulation();
  }
  template <class T>
  T get() {
    T value{};
    cdr_ >> value;
    return value;
  }
  std::int64_t stamp() {
    const auto seconds = get<std::int32_t>();
    return std::int64_t{seconds} * 1'000'000'000 + get<std::uint32_t>();
  }
  Planar pose() {
    const std::array<double, 7> v = get<std::array<double, 7>>();
    return {v[0], v[1], 2.0 * std::atan2(v[5], v[6])};
  }

 private:
  FastBuffer buffer_;
  Cdr cdr_;
};

json of(const Planar& pose) {
  return {pose.x, pose.y, std::remainder(pose.theta, 2.0 * 3.14159265358979323846)};
}

}  // namespace

json read_pose(Bytes& bytes) {
  Taken in(bytes);
  json out = {{"stamp", in.stamp()}, {"frame", in.get<std::string>()}};
  out["pose"] = of(in.pose());
  const auto covariance = in.get<std::array<double, 36>>();
  out["covariance"] = {covariance[0], covariance[1], covariance[6], covariance[7], covariance[35]};
  return out;
}
json read_map(Bytes& bytes) {
  Taken in(bytes);
  json out = {{"stamp", in.stamp()}, {"frame", in.get<std::string>()}};
  in.stamp();
  out["resolution"] = in.get<float>();
  out["width"] = in.get<std::uint32_t>();
  out["height"] = in.get<std::uint32_t>();
  out["origin"] = of(in.pose());
  const auto cells = in.get<std::vector<std::int8_t>>();
  std::uint32_t occupied = 0, free = 0, other = 0;
  for (const std::int8_t cell : cells) (cell == 100 ? occupied : cell == 0 ? free : other) += 1;
  out["cells"] = cells.size();
  out["occupied"] = occupied;
  out["free"] = free;
  return out;
}
json read_transforms(Bytes& bytes) {
  Taken in(bytes);
  json out = json::array();
  for (auto n = in.get<std::uint32_t>(); n > 0; --n) {
    json one = {{"stamp", in.stamp()}, {"parent", in.get<std::string>()}};
    one["child"] = in.get<std::string>();
    one["pose"] = of(in.pose());
    out.push_back(one);
  }
  return {{"transforms", out}};
}
json read_scan(Bytes& bytes) {
  Taken in(bytes);
  json out = {{"stamp", in.stamp()}, {"frame", in.get<std::string>()}};
  for (int i = 0; i < 7; ++i) in.get<float>();
  out["beams"] = in.get<std::vector<float>>().size();
  return out;
}
json read_path(Bytes& bytes) {
  Taken in(bytes);
  json out = {{"stamp", in.stamp()}, {"frame", in.get<std::string>()}};
  out["poses"] = in.get<std::uint32_t>();
  return out;
}
json read_text(Bytes& bytes) {
  Taken in(bytes);
  return {{"data", in.get<std::string>()}};
}
json read_diagnostics(Bytes& bytes) {
  Taken in(bytes);
  json out = {{"stamp", in.stamp()}, {"frame", in.get<std::string>()}};
  in.get<std::uint32_t>();
  out["level"] = in.get<std::uint8_t>();
  out["name"] = in.get<std::string>();
  out["message"] = in.get<std::string>();
  in.get<std::string>();
  json values = json::object();
  for (auto n = in.get<std::uint32_t>(); n > 0; --n) {
    const auto key = in.get<std::string>();
    values[key] = in.get<std::string>();
  }
  out["values"] = values;
  return out;
}

}  // namespace fast_peer
