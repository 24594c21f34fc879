// SLAM: a run, its updates, its saved states.
#include "phasescan/slam/slam.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <memory>
#include <mutex>

#include "bind.hpp"
#include "options.hpp"
#include "slam.hpp"
#include "tracking.hpp"

namespace phasescan::python {
namespace {

PyState load_state(const std::filesystem::path& path) {
  return {read_state(path.string())};
}

std::unique_ptr<PySlam> new_slam(const py::object& state, const std::string& schedule, int threads,
                                 const py::object& options, const py::kwargs& keywords) {
  if (threads < 1) throw std::invalid_argument("threads: must be 1 or more");
  if (schedule != "deterministic" && schedule != "latest")
    throw std::invalid_argument("schedule: is '" + schedule + "'; expected deterministic or latest");
  const Schedule when = schedule == "latest" ? Schedule::kLatest : Schedule::kDeterministic;
  if (state.is_none())
    return std::make_unique<PySlam>(options_from<MappingOptions>(options, keywords), when, threads > 1);
  if (!py::isinstance<PyState>(state))
    throw std::invalid_argument("state: expected a SlamState, got " + type_name(state));
  const SavedRun& saved = state.cast<const PyState&>().run;
  const py::object begun = options.is_none() ? py::cast(MappingOptions{saved.options}) : options;
  const MappingOptions asked = options_from<MappingOptions>(begun, keywords);
  const OptionDifferences differences = compare_options(asked.slam, saved.options);
  if (!differences.fatal.empty())
    throw std::invalid_argument("options: the state cannot go on with " + differences.fatal.front() +
                                "; expected those it was made with");
  return std::make_unique<PySlam>(saved.state, asked, when, threads > 1);
}

void bind_slam_update(py::module_& module) {
  py::class_<ScanUpdate> type(module, "ScanUpdate", "What one scan brought at once.");
  type.def_property_readonly("T_map_base", &ScanUpdate::T_map_base,
                             "Pose2: Of the base on the map, as far as known [m, rad].");
  type.def_property_readonly("pose", &ScanUpdate::T_map_base, "Pose2: T_map_base.");
  type.def_property_readonly(
      "T_odom_base", [](const ScanUpdate& u) { return u.T_odom_base; }, "Pose2: Continuous, drifts.");
  type.def_property_readonly(
      "T_map_odom", [](const ScanUpdate& u) { return u.T_map_odom; }, "Pose2: Correction by the map.");
  type.def_property_readonly(
      "status", [](const ScanUpdate& u) { return std::string(to_string(u.status)); },
      "str: initialising, ok, degraded, ambiguous or lost.");
  type.def_property_readonly(
      "stamp", [](const ScanUpdate& u) { return stamp_to_seconds(u.stamp); }, "float: [s].");
  type.def_property_readonly(
      "stamp_ns", [](const ScanUpdate& u) { return u.stamp; }, "int: [ns].");
  type.def_property_readonly(
      "scan", [](const ScanUpdate& u) { return u.scan; }, "int: Number of the scan, from 0.");
  type.def_property_readonly(
      "repeated", [](const ScanUpdate& u) { return u.repeated; }, "bool: The same message as before.");
  type.def_property_readonly(
      "covariance", [](const ScanUpdate& u) { return matrix_array(u.map_covariance.value_or(u.odom_covariance)); },
      "ndarray, shape (3, 3): Of T_map_base; of T_odom_base before the map's first result [m^2, m rad, rad^2].");
  type.def_property_readonly(
      "twist", [](const ScanUpdate& u) { return u.twist; }, "Twist2: Of the base [m/s, rad/s].");
  type.def_property_readonly(
      "keyframe", [](const ScanUpdate& u) { return u.keyframe; }, "int or None: The newest keyframe.");
  type.def_property_readonly(
      "map_version", [](const ScanUpdate& u) { return u.map_version; }, "int: Counts results of loops and graph.");
  type.def_property_readonly(
      "diagnostics", [](const ScanUpdate& u) { return diagnostics_dict(u.diagnostics); },
      "dict: overlap (0..1), residual_m, wide_search, full_search, new_segment.");
  type.def("__repr__", [](const ScanUpdate& u) {
    return fmt::format("<ScanUpdate {}: {} at {}>", u.scan, to_string(u.status), pose_text(u.T_map_base()));
  });
}

void bind_state(py::module_& module) {
  py::class_<PyState> type(module, "SlamState", "A run of SLAM as a value: to save, to go on from, to pickle.");
  type.def_static("load", &load_state, py::arg("path"), py::call_guard<py::gil_scoped_release>(),
                  "SlamState: Of a file that `save` or `phasescan slam --save` wrote.");
  type.def(
      "save", [](const PyState& s, const std::filesystem::path& path) { write_state(path.string(), s.run); },
      py::arg("path"), py::call_guard<py::gil_scoped_release>(),
      "Writes a file whole or not at all; `phasescan slam --resume` reads it too.");
  type.def_property_readonly(
      "scans", [](const PyState& s) { return s.run.state.scans(); }, "int: Scans so far.");
  type.def_property_readonly(
      "options", [](const PyState& s) { return MappingOptions{s.run.options}; }, "SlamOptions: Of its run.");
  type.def_property_readonly(
      "summary",
      [](const PyState& s) {
        const StateSummary summary = summarize(s.run.state);
        py::dict out;
        out["scans"] = summary.scans;
        out["keyframes"] = summary.keyframes;
        out["loops"] = summary.loops;
        out["drives"] = summary.drives;
        out["pieces"] = summary.pieces;
        out["first_stamp"] = stamp_to_seconds(summary.first_stamp);
        out["last_stamp"] = stamp_to_seconds(summary.last_stamp);
        out["path_length_m"] = summary.path_length_m;
        out["lasers"] = summary.lasers;
        return out;
      },
      "dict: scans, keyframes, loops, drives, pieces, first_stamp, last_stamp [s], path_length_m, lasers.");
  type.def("__repr__", [](const PyState& s) { return fmt::format("<SlamState of {} scans>", s.run.state.scans()); });
  type.def(py::pickle([](const PyState& s) { return py::bytes(encode_state(s.run)); },
                      [](const py::bytes& bytes) { return PyState{decode_state(std::string(bytes))}; }));
}

void bind_run(py::class_<PySlam>& type) {
  type.def(
      "add",
      [](PySlam& self, const py::object& scan, const py::object& T_base_laser, const py::object& T_odom_base,
         const std::string& laser) {
        const RangeMeasurement measurement = to_measurement_argument(scan, T_base_laser, T_odom_base, laser);
        const py::gil_scoped_release release;
        const std::lock_guard lock(self.mutex);
        return self.open().add(measurement);
      },
      py::arg("scan"), py::kw_only(), py::arg("T_base_laser") = py::none(), py::arg("T_odom_base") = py::none(),
      py::arg("laser") = "", kAddDoc);
  type.def(
      "predict",
      [](PySlam& self, double stamp) {
        const std::lock_guard lock(self.mutex);
        return self.open().predict(stamp_from_seconds(stamp));
      },
      py::arg("stamp"), py::call_guard<py::gil_scoped_release>(),
      "Pose2 or None: T_map_base at another time [s], going on as at the last scan; None while lost.");
  type.def(
      "map", [](PySlam& self) { return self.slam.map()->draw(); }, py::call_guard<py::gil_scoped_release>(),
      "TrinaryMap: Drawn as the last result left it.");
  type.def(
      "begin_session",
      [](PySlam& self) {
        const std::lock_guard lock(self.mutex);
        self.open().begin_session();
      },
      py::call_guard<py::gil_scoped_release>(),
      "What comes next is another drive: nothing but loops ties it to what was before.");
  type.def(
      "checkpoint",
      [](PySlam& self) {
        const std::lock_guard lock(self.mutex);
        return PyState{{self.open().checkpoint(), self.options.slam}};
      },
      py::call_guard<py::gil_scoped_release>(), "SlamState: All of the run so far.");
  type.def(
      "finish",
      [](PySlam& self) {
        const std::lock_guard lock(self.mutex);
        Slam& slam = self.open();
        self.finished = true;
        return std::make_shared<SlamResult>(slam.finish());
      },
      py::call_guard<py::gil_scoped_release>(),
      "SlamResult: Last loops, the full graph, the map. No `add` afterwards.");
}

}  // namespace

void bind_slam(py::module_& module) {
  bind_slam_update(module);
  bind_state(module);
  bind_slam_result(module);
  py::class_<PySlam> type(module, "Slam", R"(Tracks, closes loops and keeps the map's poses straight.

Parameters
----------
state : SlamState, optional
    A run to go on from, with its options.
schedule : str
    deterministic: the same bytes always; latest: `add` never waits.
threads : int
    2: loops and graph run beside `add`.
options : dict or SlamOptions, optional
**options
    Options by name, or a section with a dict; an unknown one names the nearest.)");
  type.def(py::init(&new_slam), py::kw_only(), py::arg("state") = py::none(), py::arg("schedule") = "deterministic",
           py::arg("threads") = 1, py::arg("options") = py::none());
  bind_run(type);
  type.def_property_readonly(
      "scans", [](const PySlam& self) { return self.slam.scans(); }, "int: Scans so far.");
  type.def_property_readonly(
      "options", [](const PySlam& self) { return self.options; }, "SlamOptions.");
  type.def("__repr__", [](const PySlam& self) { return fmt::format("<Slam after {} scans>", self.slam.scans()); });
}

}  // namespace phasescan::python
