// Shared by all parts of the Python module: what each part adds, and how scans, poses and arrays cross over.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <optional>
#include <string>

#include "phasescan/core/pose2.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan::python {

namespace py = pybind11;

void bind_errors(py::module_& module);
void bind_poses(py::module_& module);
void bind_options(py::module_& module);
void bind_scans(py::module_& module);
void bind_match(py::module_& module);
void bind_map(py::module_& module);
void bind_odometry(py::module_& module);
void bind_slam(py::module_& module);
void bind_logs(py::module_& module);
void bind_live(py::module_& module);
void bind_simulation(py::module_& module);
void bind_evaluation(py::module_& module);
void bind_localize(py::module_& module);
void bind_places(py::module_& module);

/// A keyword or value that an option does not know: a TypeError and a ValueError at once.
class OptionError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// "Scan", "list", ...: the type of an object, for messages.
std::string type_name(py::handle object);

/// (x, y, theta), an array of three, or an object with these fields. @throws std::invalid_argument naming `name`
Pose2 to_pose(py::handle object, const char* name);
std::optional<Pose2> to_optional_pose(py::handle object, const char* name);
Twist2 to_twist(py::handle object, const char* name);

/// How the beams of a bare array lie; nothing: as `match` documents.
struct ArrayGeometry {
  double angle_min = 0.0;
  std::optional<double> angle_increment;
  double range_min = 0.0;
  std::optional<double> range_max;

  ScanGeometry of(std::size_t beams) const;
};

/// Holds the scan that an argument is, or the one made of an array. @throws std::invalid_argument naming `name`
class ScanArgument {
 public:
  ScanArgument(py::handle object, const ArrayGeometry& geometry, const char* name);
  const Scan& operator*() const { return *scan_; }

 private:
  std::optional<Scan> own_;
  const Scan* scan_;
};

/// A measurement of what `add` takes: a RangeMeasurement, a LogEntry, a Scan or an array, and what is said beside it.
RangeMeasurement to_measurement_argument(py::handle object, const py::object& T_base_laser,
                                         const py::object& T_odom_base, const std::string& laser);

/// A read-only array that is a view of memory which `owner` keeps.
template <class T>
py::array view_of(const T* data, std::vector<py::ssize_t> shape, py::handle owner) {
  py::array_t<T> array(std::move(shape), data, owner);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

/// (n, 3) of x, y [m], theta [rad].
template <class Range, class PoseOf>
py::array_t<double> pose_array(const Range& range, PoseOf pose_of) {
  py::array_t<double> out({static_cast<py::ssize_t>(range.size()), py::ssize_t{3}});
  auto cell = out.mutable_unchecked<2>();
  py::ssize_t i = 0;
  for (const auto& item : range) {
    const Pose2 pose = pose_of(item);
    cell(i, 0) = pose.x;
    cell(i, 1) = pose.y;
    cell(i++, 2) = pose.theta;
  }
  return out;
}

/// (n,) of one value of each item.
template <class T, class Range, class ValueOf>
py::array_t<T> value_array(const Range& range, ValueOf value_of) {
  py::array_t<T> out(static_cast<py::ssize_t>(range.size()));
  auto cell = out.template mutable_unchecked<1>();
  py::ssize_t i = 0;
  for (const auto& item : range) cell(i++) = static_cast<T>(value_of(item));
  return out;
}

/// (3, 3), row-major.
template <class Matrix>
py::array_t<double> matrix_array(const Matrix& matrix) {
  py::array_t<double> out({3, 3});
  auto cell = out.mutable_unchecked<2>();
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) cell(i, k) = matrix(i, k);
  }
  return out;
}

/// "(0.250, -0.150, 2.0944)".
std::string pose_text(const Pose2& pose);

}  // namespace phasescan::python
