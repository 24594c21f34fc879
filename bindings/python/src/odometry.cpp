// Laser odometry: scan by scan.
#include "phasescan/odometry/odometry.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <memory>
#include <mutex>

#include "bind.hpp"
#include "options.hpp"
#include "tracking.hpp"

namespace phasescan::python {
namespace {

struct PyOdometry {
  explicit PyOdometry(TrackingOptions o) : options(std::move(o)), odometry(options.odometry) {}
  TrackingOptions options;
  Odometry odometry;
  std::mutex mutex;
};

void bind_odometry_update(py::module_& module) {
  py::class_<OdometryUpdate> type(module, "OdometryUpdate",
                                  "What one scan brought. odom is where the base stood at the first scan.");
  const auto pose = [](const OdometryUpdate& u) { return u.T_odom_base; };
  type.def_property_readonly("T_odom_base", pose, "Pose2: Of the base at the scan's stamp [m, rad].");
  type.def_property_readonly("pose", pose, "Pose2: T_odom_base.");
  type.def_property_readonly(
      "status", [](const OdometryUpdate& u) { return std::string(to_string(u.status)); },
      "str: initialising, ok, degraded, ambiguous or lost.");
  type.def_property_readonly(
      "tracked", [](const OdometryUpdate& u) { return is_tracked(u.status); }, "bool: The pose comes from a match.");
  type.def_property_readonly(
      "stamp", [](const OdometryUpdate& u) { return stamp_to_seconds(u.stamp); }, "float: [s].");
  type.def_property_readonly(
      "stamp_ns", [](const OdometryUpdate& u) { return u.stamp; }, "int: [ns].");
  type.def_property_readonly(
      "covariance", [](const OdometryUpdate& u) { return matrix_array(u.covariance); },
      "ndarray, shape (3, 3): Of (x, y, theta), since the start [m^2, m rad, rad^2].");
  type.def_property_readonly(
      "twist", [](const OdometryUpdate& u) { return u.twist; }, "Twist2: Of the base [m/s, rad/s].");
  type.def_property_readonly(
      "keyframe", [](const OdometryUpdate& u) { return u.keyframe; }, "bool: The scan became part of the local map.");
  type.def_property_readonly(
      "diagnostics", [](const OdometryUpdate& u) { return diagnostics_dict(u.diagnostics); },
      "dict: overlap (0..1), residual_m, wide_search, full_search, new_segment.");
  type.def("__repr__", [](const OdometryUpdate& u) {
    return fmt::format("<OdometryUpdate {} at {}, stamp {:.3f} s>", to_string(u.status), pose_text(u.T_odom_base),
                       stamp_to_seconds(u.stamp));
  });
}

}  // namespace

py::dict diagnostics_dict(const TrackingDiagnostics& diagnostics) {
  py::dict out;
  out["overlap"] = diagnostics.overlap;
  out["residual_m"] = diagnostics.residual_m;
  out["wide_search"] = diagnostics.wide_search;
  out["full_search"] = diagnostics.full_search;
  out["new_segment"] = diagnostics.new_segment;
  return out;
}

void bind_odometry(py::module_& module) {
  bind_odometry_update(module);
  py::class_<PyOdometry> type(module, "Odometry",
                              R"(Tracks a robot through its scans against a local map of the last keyframes.

Parameters
----------
options : dict or OdometryOptions, optional
**options
    Options of section `odometry` by name.)");
  type.def(py::init([](const py::object& options, const py::kwargs& keywords) {
             return std::make_unique<PyOdometry>(options_from<TrackingOptions>(options, keywords));
           }),
           py::kw_only(), py::arg("options") = py::none());
  type.def(
      "add",
      [](PyOdometry& self, const py::object& scan, const py::object& T_base_laser, const py::object& T_odom_base,
         const std::string& laser) {
        const RangeMeasurement measurement = to_measurement_argument(scan, T_base_laser, T_odom_base, laser);
        const py::gil_scoped_release release;
        const std::lock_guard lock(self.mutex);
        return self.odometry.add(measurement);
      },
      py::arg("scan"), py::kw_only(), py::arg("T_base_laser") = py::none(), py::arg("T_odom_base") = py::none(),
      py::arg("laser") = "", kAddDoc);
  type.def_property_readonly(
      "options", [](const PyOdometry& self) { return self.options; }, "OdometryOptions.");
  type.def("__repr__", [](const PyOdometry&) { return "<Odometry>"; });
}

}  // namespace phasescan::python
