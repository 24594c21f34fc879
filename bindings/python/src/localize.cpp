// Localisation on a map that is known.
#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <memory>
#include <mutex>

#include "bind.hpp"
#include "options.hpp"
#include "phasescan/localize/localizer.hpp"
#include "phasescan/slam/state.hpp"
#include "slam.hpp"
#include "tracking.hpp"

namespace phasescan::python {
namespace {

struct PyLocalizer {
  PyLocalizer(LocalizationMap map, LocalizingOptions o)
      : options(std::move(o)), localizer(std::move(map), options.localize, options.odometry) {}
  LocalizingOptions options;
  Localizer localizer;
  std::mutex mutex;
};

LocalizationMap map_from_grid(const TrinaryMap& grid, const py::object& options, const py::kwargs& keywords) {
  const auto asked = options_from<LocalizingOptions>(options, keywords);
  const py::gil_scoped_release release;
  return LocalizationMap::from_grid(grid, asked.localize);
}

LocalizationMap map_from_state(const PyState& state, const py::object& options, const py::kwargs& keywords) {
  const auto asked = options_from<LocalizingOptions>(options, keywords);
  const py::gil_scoped_release release;
  return LocalizationMap::from_state(state.run.state, state.run.options, asked.localize);
}

void bind_known_map(py::module_& module) {
  py::class_<LocalizationMap> type(
      module, "LocalizationMap",
      "A map made ready to be localised in: immutable; any number of localizers may share it.\n\nMade by `from_grid` or "
      "`from_state`.");
  type.def_static("from_grid", &map_from_grid, py::arg("map"), py::kw_only(), py::arg("options") = py::none(),
                  R"(Of a map of cells; poses are in the map's frame, its origin applied.

Parameters
----------
map : TrinaryMap
    For example ``TrinaryMap.load("map.yaml")``.
options, **options
    As for `Localizer`.

Returns
-------
LocalizationMap)");
  type.def_static("from_state", &map_from_state, py::arg("state"), py::kw_only(), py::arg("options") = py::none(),
                  R"(Of a saved run, as its graph stands.

Parameters
----------
state : SlamState
options, **options
    As for `Localizer`.

Returns
-------
LocalizationMap)");
  type.def_property_readonly("free_area_m2", &LocalizationMap::free_area_m2, "float: [m^2].");
  type.def_property_readonly("views", &LocalizationMap::views, "int: Places that it is described from.");
  type.def_property_readonly("memory_bytes", &LocalizationMap::memory_bytes, "int: That it takes.");
  type.def("__repr__", [](const LocalizationMap& m) {
    return fmt::format("<LocalizationMap of {:.0f} m2 free, {} views>", m.free_area_m2(), m.views());
  });
}

void bind_estimate(py::module_& module) {
  py::class_<PoseEstimate> type(module, "PoseEstimate", "A place where the robot may be.");
  const auto pose = [](const PoseEstimate& e) { return e.T_map_base; };
  type.def_property_readonly("T_map_base", pose, "Pose2: Frame of the map [m, rad].");
  type.def_property_readonly("pose", pose, "Pose2: T_map_base.");
  type.def_property_readonly(
      "covariance", [](const PoseEstimate& e) { return matrix_array(e.covariance); },
      "ndarray, shape (3, 3): [m^2, m rad, rad^2].");
  type.def_property_readonly(
      "confidence", [](const PoseEstimate& e) { return e.confidence; },
      "float: Probability of being within 0.1 m and 3 deg.");
  type.def("__repr__", [](const PoseEstimate& e) {
    return fmt::format("<PoseEstimate {} confidence {:.3f}>", pose_text(e.T_map_base), e.confidence);
  });
}

void bind_localization_update(py::module_& module) {
  using Update = LocalizationUpdate;
  py::class_<Update> type(module, "LocalizationUpdate", "What one scan says of the pose on the map.");
  const auto pose = [](const Update& u) { return u.T_map_base; };
  type.def_property_readonly("T_map_base", pose,
                             "Pose2 or None: At the scan's stamp [m, rad]; None where nothing is known.");
  type.def_property_readonly("pose", pose, "Pose2 or None: T_map_base.");
  type.def_property_readonly("usable", &Update::has_pose, "bool: The pose is one to go by: ok or degraded.");
  type.def_property_readonly(
      "status", [](const Update& u) { return std::string(to_string(u.status)); },
      "str: initialising, ok, degraded, ambiguous or lost.");
  type.def_property_readonly(
      "stamp", [](const Update& u) { return stamp_to_seconds(u.stamp); }, "float: [s].");
  type.def_property_readonly(
      "stamp_ns", [](const Update& u) { return u.stamp; }, "int: [ns].");
  type.def_property_readonly(
      "scan", [](const Update& u) { return u.scan; }, "int: Number of the scan, from 0.");
  type.def_property_readonly(
      "covariance", [](const Update& u) { return matrix_array(u.covariance); },
      "ndarray, shape (3, 3): Of (x, y, theta) on the map [m^2, m rad, rad^2].");
  type.def_property_readonly(
      "confidence", [](const Update& u) { return u.confidence; },
      "float: Probability of being within 0.1 m and 3 deg.");
  type.def_property_readonly(
      "hypotheses", [](const Update& u) { return u.hypotheses; }, "list of PoseEstimate: Best first.");
  type.def_property_readonly(
      "twist", [](const Update& u) { return u.twist; }, "Twist2: Of the base [m/s, rad/s].");
  type.def("__bool__", &Update::has_pose);
  type.def("__repr__", [](const Update& u) {
    return fmt::format("<LocalizationUpdate {}{}>", to_string(u.status),
                       u.T_map_base ? " at " + pose_text(*u.T_map_base) : "");
  });
}

void bind_localizer(py::module_& module) {
  py::class_<PyLocalizer> type(module, "Localizer", R"(Follows a robot on a known map, with no first guess.

Parameters
----------
map : LocalizationMap
options : dict or LocalizeOptions, optional
**options
    Options of sections `localize` and `odometry` by name; an unknown one names the nearest.)");
  type.def(py::init([](const LocalizationMap& map, const py::object& options, const py::kwargs& keywords) {
             return std::make_unique<PyLocalizer>(map, options_from<LocalizingOptions>(options, keywords));
           }),
           py::arg("map"), py::kw_only(), py::arg("options") = py::none());
  type.def(
      "add",
      [](PyLocalizer& self, const py::object& scan, const py::object& T_base_laser, const py::object& T_odom_base,
         const std::string& laser) {
        const RangeMeasurement measurement = to_measurement_argument(scan, T_base_laser, T_odom_base, laser);
        const py::gil_scoped_release release;
        const std::lock_guard lock(self.mutex);
        return self.localizer.add(measurement);
      },
      py::arg("scan"), py::kw_only(), py::arg("T_base_laser") = py::none(), py::arg("T_odom_base") = py::none(),
      py::arg("laser") = "", kAddDoc);
  type.def(
      "initialize",
      [](PyLocalizer& self, const py::object& pose, const Eigen::Matrix3d& covariance) {
        const Pose2 where = to_pose(pose, "pose");
        const std::lock_guard lock(self.mutex);
        self.localizer.initialize(where, covariance);
      },
      py::arg("pose"), py::arg("covariance"),
      R"(The next scan is taken near this pose.

Parameters
----------
pose : pose
    T_map_base [m, rad].
covariance : array_like, shape (3, 3)
    Of (x, y, theta) on the map [m^2, m rad, rad^2].)");
  type.def(
      "initialize_globally",
      [](PyLocalizer& self) {
        const std::lock_guard lock(self.mutex);
        self.localizer.initialize_globally();
      },
      "The robot may be anywhere: all hypotheses are dropped.");
  type.def_property_readonly(
      "map", [](const PyLocalizer& self) { return self.localizer.map(); }, "LocalizationMap.");
  type.def_property_readonly(
      "options", [](const PyLocalizer& self) { return self.options; }, "LocalizeOptions.");
  type.def("__repr__", [](const PyLocalizer& self) {
    return fmt::format("<Localizer on {:.0f} m2>", self.localizer.map().free_area_m2());
  });
}

}  // namespace

void bind_localize(py::module_& module) {
  bind_known_map(module);
  bind_estimate(module);
  bind_localization_update(module);
  bind_localizer(module);
  module.def(
      "locate",
      [](const LocalizationMap& map, const py::object& scan, const py::object& T_base_laser, const py::object& options,
         const py::kwargs& keywords) {
        const auto asked = options_from<LocalizingOptions>(options, keywords);
        const RangeMeasurement measurement = to_measurement_argument(scan, T_base_laser, py::none(), "");
        const py::gil_scoped_release release;
        return locate(map, measurement, asked.localize);
      },
      py::arg("map"), py::arg("scan"), py::kw_only(), py::arg("T_base_laser") = py::none(),
      py::arg("options") = py::none(),
      R"(locate(map, scan, *, T_base_laser=None, options=None, **keywords)
--

Where the robot is, from one scan and the map alone.

Parameters
----------
map : LocalizationMap
scan : Scan, RangeMeasurement, LogEntry or array_like, shape (n,)
T_base_laser : pose, optional
    Where the laser sits on the robot [m, rad].
options, **options
    As for `Localizer`.

Returns
-------
LocalizationUpdate)");
}

}  // namespace phasescan::python
