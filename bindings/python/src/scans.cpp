// Scans and measurements.
#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cmath>
#include <cstring>

#include "bind.hpp"
#include "phasescan/io/log.hpp"
#include "phasescan/io/scan_json.hpp"

namespace phasescan::python {
namespace {

using FloatArray = py::array_t<float, py::array::c_style | py::array::forcecast>;

std::span<const float> span_of(const FloatArray& array) {
  return {array.data(), static_cast<std::size_t>(array.size())};
}

FloatArray one_dimension(py::handle object, const char* name) {
  FloatArray array = FloatArray::ensure(object);
  if (!array) {
    PyErr_Clear();
    throw std::invalid_argument(std::string(name) + ": expected a Scan or a 1-D array of ranges [m], got " +
                                type_name(object));
  }
  if (array.ndim() != 1) {
    throw std::invalid_argument(std::string(name) + ": expected a 1-D array of ranges [m], got one of " +
                                std::to_string(array.ndim()) + " dimensions");
  }
  return array;
}

/// One value for each beam, or nothing.
std::vector<float> beam_values(const py::object& object, std::size_t beams, const char* name) {
  if (object.is_none()) return {};
  const FloatArray array = one_dimension(object, name);
  if (static_cast<std::size_t>(array.size()) != beams)
    throw std::invalid_argument(std::string(name) + ": expected one value for each of " + std::to_string(beams) +
                                " beams, got " + std::to_string(array.size()));
  return {array.data(), array.data() + array.size()};
}

Scan new_scan(const py::object& ranges, const ArrayGeometry& geometry, double stamp, double time_increment,
              const py::object& intensities, const py::object& angles) {
  const FloatArray raw = one_dimension(ranges, "ranges");
  const auto beams = static_cast<std::size_t>(raw.size());
  Scan scan = make_scan(span_of(raw), geometry.of(beams), beam_values(angles, beams, "angles"));
  if (!(std::abs(stamp) < kMostStampSeconds))
    throw std::invalid_argument("stamp: expected seconds between 1824 and 2115");
  scan.stamp = stamp_from_seconds(stamp);
  if (!std::isfinite(time_increment)) throw std::invalid_argument("time_increment: is not finite; expected seconds");
  scan.time_increment = time_increment;
  scan.intensities = beam_values(intensities, beams, "intensities");
  return scan;
}

py::array_t<double> hit_points(const Scan& scan) {
  py::array_t<double> out({static_cast<py::ssize_t>(scan.hit_count()), py::ssize_t{2}});
  auto cell = out.mutable_unchecked<2>();
  py::ssize_t row = 0;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (!scan.is_hit(i)) continue;
    cell(row, 0) = static_cast<double>(scan.ranges[i]) * std::cos(scan.angle(i));
    cell(row++, 1) = static_cast<double>(scan.ranges[i]) * std::sin(scan.angle(i));
  }
  return out;
}

template <class T>
py::bytes bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}
template <class T>
std::vector<T> vector_of(const py::object& object) {
  const std::string bytes = object.cast<std::string>();
  std::vector<T> out(bytes.size() / sizeof(T));
  if (!out.empty()) std::memcpy(out.data(), bytes.data(), out.size() * sizeof(T));
  return out;
}

py::tuple scan_state(const Scan& s) {
  return py::make_tuple(s.stamp, s.geometry.angle_min, s.geometry.angle_increment, s.geometry.range_min,
                        s.geometry.range_max, s.time_increment, bytes_of(s.ranges), bytes_of(s.states),
                        bytes_of(s.angles), bytes_of(s.intensities));
}

Scan scan_from_state(const py::tuple& state) {
  if (state.size() != 10) throw std::invalid_argument("not the state of a Scan");
  Scan scan;
  scan.stamp = state[0].cast<Stamp>();
  scan.geometry = {state[1].cast<double>(), state[2].cast<double>(), state[3].cast<double>(), state[4].cast<double>()};
  scan.time_increment = state[5].cast<double>();
  scan.ranges = vector_of<float>(state[6]);
  scan.states = vector_of<BeamState>(state[7]);
  scan.angles = vector_of<float>(state[8]);
  scan.intensities = vector_of<float>(state[9]);
  const auto fits = [&](std::size_t size) { return size == 0 || size == scan.size(); };
  if (scan.states.size() != scan.size() || !fits(scan.angles.size()) || !fits(scan.intensities.size()))
    throw std::invalid_argument("not the state of a Scan");
  return scan;
}

std::string scan_text(const Scan& s) {
  return fmt::format("<Scan of {} beams, {} with a range, up to {:.2f} m, stamp {:.3f} s>", s.size(), s.hit_count(),
                     s.effective_range_max(), stamp_to_seconds(s.stamp));
}

constexpr const char* kScanDoc = R"(One turn of a planar lidar.

Parameters
----------
ranges : array_like, shape (n,)
    Ranges [m]; 0, nan, inf and those outside the limits are missing, each for its reason.
angle_min : float
    Direction of the first beam [rad], counter-clockwise from x forward.
angle_increment : float, optional
    From beam to beam [rad], negative for clockwise sensors; a full turn, ``2 * pi / n``, unless given.
range_min, range_max : float, optional
    Limits of the sensor [m]; 0 and None are unknown.
stamp : float
    Time of the first beam [s].
time_increment : float
    From beam to beam [s]; 0 is unknown.
intensities, angles : array_like, shape (n,), optional
    Angles [rad] replace `angle_min` and `angle_increment`.)";

void bind_scan_values(py::class_<Scan>& type) {
  type.def_property_readonly(
      "ranges",
      [](const py::object& self) {
        const auto& scan = self.cast<const Scan&>();
        return view_of(scan.ranges.data(), {static_cast<py::ssize_t>(scan.size())}, self);
      },
      "ndarray, shape (n,), float32: [m], nan where a beam is missing; a view, read-only.");
  type.def_property_readonly(
      "states",
      [](const py::object& self) {
        const auto& scan = self.cast<const Scan&>();
        return view_of(reinterpret_cast<const std::uint8_t*>(scan.states.data()),
                       {static_cast<py::ssize_t>(scan.size())}, self);
      },
      "ndarray, shape (n,), uint8: 0 a range, 1 no return, 2 out of range, 3 too near, 4 invalid; a view, read-only.");
  type.def_property_readonly(
      "intensities",
      [](const py::object& self) -> py::object {
        const auto& scan = self.cast<const Scan&>();
        if (scan.intensities.empty()) return py::none();
        return view_of(scan.intensities.data(), {static_cast<py::ssize_t>(scan.size())}, self);
      },
      "ndarray, shape (n,), float32, or None: a view, read-only.");
  type.def_property_readonly(
      "angles",
      [](const Scan& scan) {
        py::array_t<double> out(static_cast<py::ssize_t>(scan.size()));
        auto cell = out.mutable_unchecked<1>();
        for (std::size_t i = 0; i < scan.size(); ++i) cell(static_cast<py::ssize_t>(i)) = scan.angle(i);
        return out;
      },
      "ndarray, shape (n,): Direction of each beam [rad].");
  type.def("points", &hit_points, R"(Where the beams ended.

Returns
-------
ndarray, shape (hits, 2)
    x, y [m] in the laser's frame, of beams with a range.)");
}

void bind_scan(py::module_& module) {
  py::class_<Scan> type(module, "Scan", kScanDoc);
  type.def(py::init([](const py::object& ranges, double angle_min, std::optional<double> angle_increment,
                       double range_min, std::optional<double> range_max, double stamp, double time_increment,
                       const py::object& intensities, const py::object& angles) {
             return new_scan(ranges, {angle_min, angle_increment, range_min, range_max}, stamp, time_increment,
                             intensities, angles);
           }),
           py::arg("ranges"), py::kw_only(), py::arg("angle_min") = 0.0, py::arg("angle_increment") = py::none(),
           py::arg("range_min") = 0.0, py::arg("range_max") = py::none(), py::arg("stamp") = 0.0,
           py::arg("time_increment") = 0.0, py::arg("intensities") = py::none(), py::arg("angles") = py::none());
  bind_scan_values(type);
  type.def_static(
      "from_json", [](const std::string& text) { return parse_scan_json(text, "scan"); }, py::arg("text"),
      "Scan: Of its text as scan JSON.");
  type.def_static(
      "load", [](const std::filesystem::path& path) { return read_scan_file(path.string()); }, py::arg("path"),
      "Scan: Of a scan JSON file.");
  type.def("to_json", &format_scan_json, "str: One line of scan JSON, from which the same scan is read again.");
  type.def("mirrored", &mirrored_scan, "Scan: As an upright laser would see it, of one mounted upside down.");
  type.def("reduced", &reduce_scan, py::kw_only(), py::arg("range_max") = 0.0, py::arg("beam_step") = 1,
           "Scan: Cut down to a cheaper sensor: hits beyond `range_max` [m] out of range, every `beam_step`-th beam.");
  type.def_property_readonly(
      "stamp", [](const Scan& s) { return stamp_to_seconds(s.stamp); }, "float: Time of the first beam [s].");
  type.def_property_readonly(
      "stamp_ns", [](const Scan& s) { return s.stamp; }, "int: The same [ns], exact.");
  type.def_property_readonly(
      "angle_min", [](const Scan& s) { return s.geometry.angle_min; }, "float: [rad].");
  type.def_property_readonly(
      "angle_increment", [](const Scan& s) { return s.geometry.angle_increment; }, "float: [rad].");
  type.def_property_readonly(
      "range_min", [](const Scan& s) { return s.geometry.range_min; }, "float: [m], 0 unknown.");
  type.def_property_readonly(
      "range_max", [](const Scan& s) { return s.geometry.range_max; }, "float: [m], 0 unknown.");
  type.def_property_readonly(
      "time_increment", [](const Scan& s) { return s.time_increment; }, "float: [s].");
  type.def_property_readonly("hit_count", &Scan::hit_count, "int: Beams with a range.");
  type.def("__len__", &Scan::size);
  type.def("__repr__", &scan_text);
  type.def(
      "__eq__",
      [](const Scan& a, const py::object& b) {
        return py::isinstance<Scan>(b) && scan_state(a).equal(scan_state(b.cast<const Scan&>()));
      },
      py::arg("other"));
  type.attr("__hash__") = py::none();
  type.def(py::pickle(&scan_state, &scan_from_state));
}

void bind_measurement(py::module_& module) {
  py::class_<RangeMeasurement> type(module, "RangeMeasurement",
                                    R"(One scan of one laser of a robot, as `Odometry.add` and `Slam.add` take it.

Parameters
----------
scan : Scan or array_like, shape (n,)
T_base_laser : pose, optional
    Where the laser sits on the robot.
T_odom_base : pose, optional
    Where wheel odometry has the robot at the scan's stamp.
laser : str
    Scans of one name are of one laser.)");
  type.def(py::init(&to_measurement_argument), py::arg("scan"), py::kw_only(), py::arg("T_base_laser") = py::none(),
           py::arg("T_odom_base") = py::none(), py::arg("laser") = "");
  type.def_property_readonly(
      "scan", [](const RangeMeasurement& m) -> const Scan& { return m.scan; },
      py::return_value_policy::reference_internal, "Scan.");
  type.def_property_readonly(
      "laser", [](const RangeMeasurement& m) { return m.laser; }, "str.");
  type.def_property_readonly(
      "T_base_laser", [](const RangeMeasurement& m) { return m.T_base_laser; }, "Pose2.");
  type.def_property_readonly(
      "T_odom_base", [](const RangeMeasurement& m) { return m.T_odom_base; }, "Pose2 or None.");
  type.def("__repr__", [](const RangeMeasurement& m) { return "<RangeMeasurement " + scan_text(m.scan) + ">"; });
}

}  // namespace

ScanGeometry ArrayGeometry::of(std::size_t beams) const {
  const double full_turn = beams > 0 ? kTwoPi / static_cast<double>(beams) : 0.0;
  return {angle_min, angle_increment.value_or(full_turn), range_min, range_max.value_or(0.0)};
}

ScanArgument::ScanArgument(py::handle object, const ArrayGeometry& geometry, const char* name) {
  if (py::isinstance<Scan>(object)) {
    scan_ = &object.cast<const Scan&>();
    return;
  }
  const FloatArray raw = one_dimension(object, name);
  own_ = make_scan(span_of(raw), geometry.of(static_cast<std::size_t>(raw.size())));
  scan_ = &*own_;
}

RangeMeasurement to_measurement_argument(py::handle object, const py::object& T_base_laser,
                                         const py::object& T_odom_base, const std::string& laser) {
  RangeMeasurement measurement;
  if (py::isinstance<RangeMeasurement>(object)) {
    measurement = object.cast<const RangeMeasurement&>();
  } else if (py::isinstance<LogEntry>(object)) {
    measurement = to_measurement(object.cast<const LogEntry&>());
  } else {
    measurement.scan = *ScanArgument(object, {}, "scan");
  }
  if (!T_base_laser.is_none()) measurement.T_base_laser = to_pose(T_base_laser, "T_base_laser");
  if (!T_odom_base.is_none()) measurement.T_odom_base = to_pose(T_odom_base, "T_odom_base");
  if (!laser.empty()) measurement.laser = laser;
  return measurement;
}

void bind_scans(py::module_& module) {
  bind_scan(module);
  bind_measurement(module);
}

}  // namespace phasescan::python
