/// What state writers and readers have to know of a type beside its `visit`.
#pragma once

#include <stdexcept>
#include <string>

#include "phasescan/core/pose2.hpp"

namespace phasescan {

/// Bytes that are no state, or a damaged one: what is wrong and what was expected, without the file's name.
class StateFormatError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Names the fields of a type. Specialised where the type has no `visit` of its own.
template <class T>
struct StateFields {
  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    T::visit(self, v);
  }
};

template <>
struct StateFields<Pose2> {
  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("x", self.x);
    v("y", self.y);
    v("theta", self.theta);
  }
};

template <>
struct StateFields<Twist2> {
  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("vx", self.vx);
    v("vy", self.vy);
    v("omega", self.omega);
  }
};

/// How many values an enum has, from 0 on. Specialised for each that stands in a state: others are not read.
template <class E>
inline constexpr int kStateEnumCount = 0;

/// What is wrong with a value that was read, so that work with it would go astray; null: nothing. Overloaded for types
/// that have such values.
template <class T>
const char* state_problem(const T&) {
  return nullptr;
}
inline const char* state_problem(const Pose2& pose) {
  return pose.is_finite() ? nullptr : "a pose that is not finite";
}

/// A field that came with version `since` of its state: files of earlier versions keep the default.
template <class Visitor, class T>
void visit_since(Visitor& v, int since, const char* name, T& value) {
  if constexpr (requires { v.version(); }) {
    if (v.version() < since) return;
  }
  v(name, value);
}

}  // namespace phasescan
