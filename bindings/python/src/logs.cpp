// Logs of any readable format, front to back.
#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <memory>

#include "bind.hpp"
#include "phasescan/io/log.hpp"

namespace phasescan::python {
namespace {

struct PyLog {
  std::string path;
  std::unique_ptr<LogReader> reader;
};

struct LogArguments {
  std::string topic, frame, columns, stamp_unit;
  std::optional<double> fov_deg, angle_min_deg, angle_increment_deg;
  bool clockwise = false;
  double range_min = 0.0, range_max = 0.0;
  std::vector<std::pair<double, double>> mask_deg;
  std::optional<double> from, to;
};

LogOptions options_of(const LogArguments& a) {
  const auto radians = [](std::optional<double> degrees) {
    return degrees ? std::optional<double>(deg_to_rad(*degrees)) : std::nullopt;
  };
  LogOptions options{a.topic, a.frame, a.columns, a.stamp_unit, {}, a.range_min, a.range_max, {}, a.from, a.to};
  options.beams = {radians(a.fov_deg), radians(a.angle_min_deg), radians(a.angle_increment_deg), a.clockwise};
  for (const auto& [first, last] : a.mask_deg) options.masks.push_back({deg_to_rad(first), deg_to_rad(last)});
  return options;
}

PyLog open_path(const std::filesystem::path& path, const std::string& topic, const std::string& frame,
                const std::string& columns, const std::string& stamp_unit, std::optional<double> fov_deg,
                std::optional<double> angle_min_deg, std::optional<double> angle_increment_deg, bool clockwise,
                double range_min, double range_max, const std::vector<std::pair<double, double>>& mask_deg,
                std::optional<double> from_s, std::optional<double> to_s) {
  const std::string name = path.string();
  const LogOptions options = options_of({topic, frame, columns, stamp_unit, fov_deg, angle_min_deg, angle_increment_deg,
                                         clockwise, range_min, range_max, mask_deg, from_s, to_s});
  const py::gil_scoped_release release;
  return {name, open_log(name, options)};
}

py::list rows_of(const std::vector<LogDamage>& damages) {
  py::list rows;
  for (const LogDamage& damage : damages) rows.append(py::make_tuple(damage.kind, damage.text));
  return rows;
}

void bind_entry(py::module_& module) {
  py::class_<LogEntry> type(module, "LogEntry", "One laser message of a log; `Odometry.add` and `Slam.add` take it.");
  type.def_property_readonly(
      "scan", [](const LogEntry& e) -> const Scan& { return e.scan; }, py::return_value_policy::reference_internal,
      "Scan.");
  type.def_property_readonly(
      "stamp", [](const LogEntry& e) { return stamp_to_seconds(e.scan.stamp); }, "float: [s].");
  type.def_property_readonly(
      "odometry", [](const LogEntry& e) { return e.odometry; }, "Pose2 or None: T_odom_base at the stamp [m, rad].");
  type.def_property_readonly(
      "corrected", [](const LogEntry& e) { return e.corrected; }, "Pose2 or None: What the log calls its estimate.");
  type.def_property_readonly(
      "T_base_laser", [](const LogEntry& e) { return e.T_base_laser; }, "Pose2: Where the laser sits [m, rad].");
  type.def_property_readonly(
      "flipped", [](const LogEntry& e) { return e.flipped; }, "bool: Mounted upside down.");
  type.def_property_readonly(
      "laser", [](const LogEntry& e) { return e.laser; }, "str: Topic or keyword.");
  type.def_property_readonly(
      "line", [](const LogEntry& e) { return e.line; }, "int: Line or ordinal in the file, from 1.");
  type.def_property_readonly(
      "measurement", [](const LogEntry& e) { return to_measurement(e); }, "RangeMeasurement: Upright.");
  type.def("__repr__", [](const LogEntry& e) {
    return fmt::format("<LogEntry {}: {} beams, stamp {:.3f} s>", e.line, e.scan.size(),
                       stamp_to_seconds(e.scan.stamp));
  });
}

constexpr const char* kOpenDoc =
    R"(open_log(path, *, topic='', frame='', columns='', stamp_unit='', fov_deg=None, angle_min_deg=None,
         angle_increment_deg=None, clockwise=False, range_min=0.0, range_max=0.0, mask_deg=[], from_s=None,
         to_s=None)
--

Opens a log of any readable format.

Parameters
----------
path : path
    A file, plain or packed, or a recording's folder.
topic, frame : str
    ROS: only scans of this topic, of this frame.
columns : str
    Text: names of its columns, where the file has no header.
stamp_unit : str
    Text: s, ms, us or ns.
fov_deg, angle_min_deg, angle_increment_deg : float, optional
    Text: how the beams lie [deg].
clockwise : bool
range_min, range_max : float
    Hits nearer or farther [m] are missing; 0 is no limit.
mask_deg : list of (float, float)
    Directions that say nothing [deg], counter-clockwise from the first to the second.
from_s, to_s : float, optional
    Seconds after the first scan.

Returns
-------
LogReader
    Iterates over LogEntry.

Raises
------
InputError, SystemError)";

}  // namespace

void bind_logs(py::module_& module) {
  bind_entry(module);
  py::class_<PyLog> type(module, "LogReader", "A log, front to back in bounded memory: an iterator of LogEntry.");
  type.def("__iter__", [](const py::object& self) { return self; });
  type.def("__next__", [](PyLog& self) {
    std::optional<LogEntry> entry;
    {
      const py::gil_scoped_release release;
      entry = self.reader->next();
    }
    if (!entry) throw py::stop_iteration();
    return std::move(*entry);
  });
  type.def_property_readonly(
      "path", [](const PyLog& self) { return self.path; }, "str.");
  type.def_property_readonly(
      "format", [](const PyLog& self) { return self.reader->format(); }, "str: carmen, mcap, rosbag1, ...");
  type.def_property_readonly(
      "facts", [](const PyLog& self) { return self.reader->facts(); }, "dict of str.");
  type.def_property_readonly(
      "damages", [](const PyLog& self) { return rows_of(self.reader->damages()); },
      "list of (str, str): Kind and text of what could not be read so far, the first 100.");
  type.def_property_readonly(
      "damage_count", [](const PyLog& self) { return self.reader->damage_count(); }, "int: All of them.");
  type.def_property_readonly(
      "remarks",
      [](const PyLog& self) {
        py::list rows;
        for (const LogRemark& remark : self.reader->remarks()) rows.append(py::make_tuple(remark.kind, remark.text));
        return rows;
      },
      "list of (str, str): What was assumed or left out; complete at the end.");
  type.def("__repr__",
           [](const PyLog& self) { return fmt::format("<LogReader of {} ({})>", self.path, self.reader->format()); });
  module.def("open_log", &open_path, py::arg("path"), py::kw_only(), py::arg("topic") = "", py::arg("frame") = "",
             py::arg("columns") = "", py::arg("stamp_unit") = "", py::arg("fov_deg") = py::none(),
             py::arg("angle_min_deg") = py::none(), py::arg("angle_increment_deg") = py::none(),
             py::arg("clockwise") = false, py::arg("range_min") = 0.0, py::arg("range_max") = 0.0,
             py::arg("mask_deg") = py::list(), py::arg("from_s") = py::none(), py::arg("to_s") = py::none(), kOpenDoc);
}

}  // namespace phasescan::python
