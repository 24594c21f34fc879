// A state as bytes: what its `visit` names, field by field. Two states with the same bytes are the same.
#pragma once

#include <Eigen/Core>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "odometry/map_points.hpp"
#include "phasescan/core/pose2.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan::testing {

class StateBytes {
 public:
  template <class T>
  void operator()(std::string_view name, const T& value) {
    bytes_ += name;
    write(value);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  void raw(const void* data, std::size_t size) { bytes_.append(static_cast<const char*>(data), size); }
  template <class T>
  void write(const T& value) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
      raw(&value, sizeof(value));
    } else if constexpr (requires { T::visit(value, *this); }) {
      T::visit(value, *this);
    } else {
      describe(value);
    }
  }
  template <class T>
  void describe(const std::vector<T>& values) {
    write(values.size());
    for (const T& v : values) write(v);
  }
  template <class T>
  void describe(const std::optional<T>& value) {
    write(value.has_value());
    if (value) write(*value);
  }
  template <class T>
  void describe(const std::shared_ptr<T>& value) {
    write(value != nullptr);
    if (value) write(*value);
  }
  void describe(const std::string& text) {
    write(text.size());
    bytes_ += text;
  }
  template <class Scalar, int Rows, int Cols, int Options>
  void describe(const Eigen::Matrix<Scalar, Rows, Cols, Options>& m) {
    raw(m.data(), sizeof(Scalar) * static_cast<std::size_t>(m.size()));
  }
  void describe(const Pose2& p) { write(p.x), write(p.y), write(p.theta); }
  void describe(const Twist2& t) { write(t.vx), write(t.vy), write(t.omega); }
  void describe(const MapPoints& p) {
    for (const auto* v : {&p.x, &p.y, &p.nx, &p.ny, &p.variance, &p.normal_variance}) describe(*v);
    describe(p.free_standing);
    write(p.with_normal);
  }
  void describe(const Scan& s) {
    write(s.stamp);
    describe(s.ranges);
    describe(s.states);
    describe(s.angles);
  }
  std::string bytes_;
};

template <class State>
std::string state_bytes(const State& state) {
  StateBytes out;
  State::visit(state, out);
  return out.bytes();
}

}  // namespace phasescan::testing
