// Any state with a `visit` as bytes, and back: what is not visited is lost.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan::testing {

class StateWriter {
 public:
  std::string bytes;

  template <class T>
  void operator()(const char*, const T& value) {
    write(value);
  }

  template <class T>
  void write(const T& value) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
      bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
    } else {
      T::visit(value, *this);
    }
  }
  void write(const Pose2& p) { write(p.x), write(p.y), write(p.theta); }
  void write(const Twist2& t) { write(t.vx), write(t.vy), write(t.omega); }
  void write(const Scan& s) { write(s.stamp), write(s.ranges), write(s.states), write(s.angles); }
  void write(const std::string& text) {
    write(text.size());
    bytes += text;
  }
  template <class T, int R, int C>
  void write(const Eigen::Matrix<T, R, C>& m) {
    for (Eigen::Index i = 0; i < m.size(); ++i) write(m.data()[i]);
  }
  template <class T>
  void write(const std::vector<T>& values) {
    write(values.size());
    for (const T& value : values) write(value);
  }
  template <class T>
  void write(const std::optional<T>& value) {
    write(value.has_value());
    if (value) write(*value);
  }
  template <class T>
  void write(const std::shared_ptr<const T>& value) {
    write(value != nullptr);
    if (value) write(*value);
  }
};

class StateReader {
 public:
  explicit StateReader(const std::string& bytes) : at_(bytes.data()), end_(bytes.data() + bytes.size()) {}

  template <class T>
  void operator()(const char*, T& value) {
    read(value);
  }

  template <class T>
  void read(T& value) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
      std::memcpy(&value, at_, sizeof(T));
      at_ += sizeof(T);
    } else {
      T::visit(value, *this);
    }
  }
  void read(Pose2& p) { read(p.x), read(p.y), read(p.theta); }
  void read(Twist2& t) { read(t.vx), read(t.vy), read(t.omega); }
  void read(std::string& text) {
    text.assign(size(), ' ');
    for (char& c : text) read(c);
  }
  template <class T, int R, int C>
  void read(Eigen::Matrix<T, R, C>& m) {
    for (Eigen::Index i = 0; i < m.size(); ++i) read(m.data()[i]);
  }
  template <class T>
  void read(std::vector<T>& values) {
    values.resize(size());
    for (T& value : values) read(value);
  }
  template <class T>
  void read(std::optional<T>& value) {
    value.reset();
    if (flag()) read(value.emplace());
  }
  template <class T>
  void read(std::shared_ptr<const T>& value) {
    value.reset();
    if (!flag()) return;
    const auto made = std::make_shared<T>();
    read(*made);
    value = made;
  }
  bool at_end() const { return at_ == end_; }

 private:
  std::size_t size() {
    std::size_t n = 0;
    read(n);
    return n;
  }
  bool flag() {
    bool set = false;
    read(set);
    return set;
  }
  const char* at_;
  const char* end_;
};

template <class State>
std::string to_bytes(const State& state) {
  StateWriter writer;
  State::visit(state, writer);
  return std::move(writer.bytes);
}

template <class State>
State from_bytes(const std::string& bytes) {
  State state;
  StateReader reader(bytes);
  State::visit(state, reader);
  return state;
}

}  // namespace phasescan::testing
