// Poses and velocities.
#include <fmt/format.h>

#include <array>
#include <cstring>

#include "bind.hpp"

namespace phasescan::python {
namespace {

[[noreturn]] void refuse(py::handle object, const char* name, const char* expected) {
  throw std::invalid_argument(std::string(name) + ": expected " + expected + ", got " + type_name(object));
}

std::array<double, 3> three_numbers(py::handle object, const char* name, const char* expected) {
  if (!py::isinstance<py::sequence>(object) && !py::isinstance<py::array>(object)) refuse(object, name, expected);
  const auto items = py::reinterpret_borrow<py::object>(object);
  if (py::isinstance<py::str>(object) || py::len(items) != 3) refuse(object, name, expected);
  std::array<double, 3> out{};
  for (std::size_t i = 0; i < 3; ++i) {
    try {
      out[i] = py::float_(py::object(items[py::int_(i)]));
    } catch (const py::error_already_set&) {
      refuse(object, name, expected);
    }
  }
  return out;
}

double component(const std::array<double, 3>& values, py::ssize_t index) {
  const py::ssize_t i = index < 0 ? index + 3 : index;
  if (i < 0 || i > 2) throw py::index_error("a pose has x, y and theta");
  return values[static_cast<std::size_t>(i)];
}

std::array<double, 3> numbers_of(const Pose2& pose) {
  return {pose.x, pose.y, pose.theta};
}
std::array<double, 3> numbers_of(const Twist2& twist) {
  return {twist.vx, twist.vy, twist.omega};
}

/// What a tuple of three can do.
template <class T>
void add_sequence(py::class_<T>& type) {
  type.def("__len__", [](const T&) { return 3; });
  type.def(
      "__getitem__", [](const T& value, py::ssize_t i) { return component(numbers_of(value), i); }, py::arg("index"));
  type.def("__iter__", [](const T& value) {
    const auto n = numbers_of(value);
    return py::iter(py::make_tuple(n[0], n[1], n[2]));
  });
  type.def(
      "__array__",
      [](const T& value, const py::object& dtype) -> py::object {
        const auto n = numbers_of(value);
        py::array_t<double> out(3, n.data());
        return dtype.is_none() ? py::object(out) : py::object(out.attr("astype")(dtype));
      },
      py::arg("dtype") = py::none());
  type.def(
      "__eq__",
      [](const T& a, const py::object& b) {
        return py::isinstance<T>(b) && numbers_of(a) == numbers_of(b.cast<const T&>());
      },
      py::arg("other"));
  type.def("__hash__", [](const T& value) {
    const auto n = numbers_of(value);
    return py::hash(py::make_tuple(n[0], n[1], n[2]));
  });
  type.def(py::pickle(
      [](const T& value) {
        const auto n = numbers_of(value);
        return py::make_tuple(n[0], n[1], n[2]);
      },
      [](const py::tuple& state) {
        return T{state[0].cast<double>(), state[1].cast<double>(), state[2].cast<double>()};
      }));
}

void bind_pose(py::module_& module) {
  py::class_<Pose2> type(module, "Pose2", R"(Planar rigid motion: ``p_a = R(theta) p_b + (x, y)`` for ``T_a_b``.

Unpacks, indexes and converts to numpy as ``(x, y, theta)``.

Parameters
----------
x, y : float
    Translation [m].
theta : float
    Rotation [rad], counter-clockwise.)");
  type.def(py::init([](double x, double y, double theta) {
             return Pose2{x, y, theta};
           }),
           py::arg("x") = 0.0, py::arg("y") = 0.0, py::arg("theta") = 0.0);
  type.def_property_readonly(
      "x", [](const Pose2& p) { return p.x; }, "float: [m].");
  type.def_property_readonly(
      "y", [](const Pose2& p) { return p.y; }, "float: [m].");
  type.def_property_readonly(
      "theta", [](const Pose2& p) { return p.theta; }, "float: [rad].");
  type.def("inverse", &Pose2::inverse, "T_b_a of T_a_b.");
  type.def(
      "__mul__", [](const Pose2& a, const py::object& b) { return a * to_pose(b, "pose"); }, py::arg("other"));
  type.def(
      "transform",
      [](const Pose2& pose, const py::array_t<double, py::array::c_style | py::array::forcecast>& points) {
        if (points.ndim() != 2 || points.shape(1) != 2)
          throw std::invalid_argument("points: expected an array of shape (n, 2)");
        py::array_t<double> out({points.shape(0), py::ssize_t{2}});
        auto cell = out.mutable_unchecked<2>();
        const auto in = points.unchecked<2>();
        const Eigen::Matrix2d R = pose.rotation();
        for (py::ssize_t i = 0; i < points.shape(0); ++i) {
          cell(i, 0) = R(0, 0) * in(i, 0) + R(0, 1) * in(i, 1) + pose.x;
          cell(i, 1) = R(1, 0) * in(i, 0) + R(1, 1) * in(i, 1) + pose.y;
        }
        return out;
      },
      py::arg("points"), R"(Takes points of frame b into frame a.

Parameters
----------
points : ndarray, shape (n, 2)
    Frame b [m].

Returns
-------
ndarray, shape (n, 2)
    Frame a [m].)");
  type.def("__repr__",
           [](const Pose2& p) { return fmt::format("Pose2(x={:.6g}, y={:.6g}, theta={:.6g})", p.x, p.y, p.theta); });
  add_sequence(type);
}

void bind_twist(py::module_& module) {
  py::class_<Twist2> type(module, "Twist2", R"(Planar velocity in the body's frame.

Parameters
----------
vx, vy : float
    [m/s].
omega : float
    [rad/s], counter-clockwise.)");
  type.def(py::init([](double vx, double vy, double omega) {
             return Twist2{vx, vy, omega};
           }),
           py::arg("vx") = 0.0, py::arg("vy") = 0.0, py::arg("omega") = 0.0);
  type.def_property_readonly(
      "vx", [](const Twist2& t) { return t.vx; }, "float: [m/s], forward.");
  type.def_property_readonly(
      "vy", [](const Twist2& t) { return t.vy; }, "float: [m/s], to the left.");
  type.def_property_readonly(
      "omega", [](const Twist2& t) { return t.omega; }, "float: [rad/s].");
  type.def("__repr__", [](const Twist2& t) {
    return fmt::format("Twist2(vx={:.6g}, vy={:.6g}, omega={:.6g})", t.vx, t.vy, t.omega);
  });
  add_sequence(type);
}

}  // namespace

Pose2 to_pose(py::handle object, const char* name) {
  constexpr const char* kExpected = "a pose: (x, y, theta), or an object with these fields";
  if (py::isinstance<Pose2>(object)) return object.cast<const Pose2&>();
  std::array<double, 3> n{};
  if (py::hasattr(object, "x") && py::hasattr(object, "y") && py::hasattr(object, "theta")) {
    n = three_numbers(py::make_tuple(object.attr("x"), object.attr("y"), object.attr("theta")), name, kExpected);
  } else {
    n = three_numbers(object, name, kExpected);
  }
  const Pose2 pose{n[0], n[1], wrap_angle(n[2])};
  if (!pose.is_finite()) throw std::invalid_argument(std::string(name) + ": is not finite; expected " + kExpected);
  return pose;
}

std::optional<Pose2> to_optional_pose(py::handle object, const char* name) {
  if (object.is_none()) return std::nullopt;
  return to_pose(object, name);
}

Twist2 to_twist(py::handle object, const char* name) {
  if (object.is_none()) return {};
  if (py::isinstance<Twist2>(object)) return object.cast<const Twist2&>();
  const auto n = three_numbers(object, name, "a velocity: (vx, vy, omega)");
  return {n[0], n[1], n[2]};
}

std::string pose_text(const Pose2& pose) {
  return fmt::format("({:.3f} m, {:.3f} m, {:.2f} deg)", pose.x, pose.y, rad_to_deg(pose.theta));
}

void bind_poses(py::module_& module) {
  bind_pose(module);
  bind_twist(module);
}

}  // namespace phasescan::python
