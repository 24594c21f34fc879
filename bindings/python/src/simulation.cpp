// Simulated drives: scans and their truth.
#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "bind.hpp"
#include "core/random.hpp"
#include "io/file.hpp"
#include "io/scan_log.hpp"
#include "io/tum.hpp"
#include "options.hpp"
#include "phasescan/io/error.hpp"
#include "sim/drive.hpp"
#include "sim/pairs_spec.hpp"
#include "sim/world_file.hpp"

namespace phasescan::python {
namespace {

/// Sections of a drive.
struct DriveSections {
  sim::PathOptions path;
  sim::DriveOptions drive;

  template <class Self, class Visitor>
  static void visit_sections(Self& self, Visitor&& v) {
    v("path", self.path);
    v("drive", self.drive);
  }
};

struct SimulatedLog {
  std::vector<LogEntry> entries;
  std::vector<StampedPose> truth;
};

sim::Path plan_path(const std::string& name, const sim::World& world, sim::PathOptions options, std::uint64_t seed) {
  const auto kinds = enum_names<sim::PathKind>();
  if (std::find(kinds.begin(), kinds.end(), name) != kinds.end()) {
    options.kind = enum_from_string<sim::PathKind>(name);
    return {world, options, seed};
  }
  if (std::filesystem::exists(name)) return {sim::read_points(name), options, seed};
  throw InputError(name, 0, "no such file, and no kind of path" + did_you_mean(name, kinds));
}

std::shared_ptr<SimulatedLog> simulate(const std::string& world_name, const std::string& sensor,
                                       const std::string& path_name, std::uint64_t seed, bool motion,
                                       const py::kwargs& keywords) {
  const auto options = options_from<DriveSections>(py::none(), keywords);
  const py::gil_scoped_release release;
  const sim::World world = sim::world_by_name(world_name, seed);
  sim::LidarOptions lidar = sim::read_lidar(sensor);
  lidar.motion = lidar.motion && motion;
  sim::Drive drive(world, lidar, plan_path(path_name, world, options.path, Random::derive(seed, 1)), options.drive,
                   Random::derive(seed, 2));
  auto log = std::make_shared<SimulatedLog>();
  while (auto scan = drive.next()) {
    log->truth.push_back({scan->entry.scan.stamp, scan->T_world_laser});
    log->entries.push_back(std::move(scan->entry));
  }
  return log;
}

void save(const SimulatedLog& log, const std::filesystem::path& path) {
  ScanLogWriter writer(path.string());
  for (const LogEntry& entry : log.entries) writer.write(entry);
  // Both or none: when the log is put in place, nothing can fail for its truth any more.
  AtomicFile truth(path.string() + ".truth.tum");
  truth.write(format_tum(log.truth));
  truth.seal();
  writer.commit();
  truth.commit();
}

constexpr const char* kSimulateDoc =
    R"(simulate(world='flat', *, sensor='rplidar-a1', path='tour', seed=1, motion=True, **keywords)
--

Simulates a drive of a robot with a lidar.

Parameters
----------
world : str
    A kind (flat, office, building, ...), KIND:SEED for one building, or a YAML file.
sensor : str
    A sensor by name, or a YAML file.
path : str
    tour, circle, back-and-forth, turn, stand, or a YAML file of points.
seed : int
    The same seed gives the same bytes, those of `phasescan simulate`.
motion : bool
    Each beam at its own time; else all at the scan's stamp.
**options
    speed_mps, turn_rate_dps, duration_s, people, odometry, ...: an unknown one names the nearest.

Returns
-------
SimulatedLog
    A sequence of LogEntry, with its truth.)";

}  // namespace

void bind_simulation(py::module_& module) {
  py::class_<SimulatedLog, std::shared_ptr<SimulatedLog>> type(module, "SimulatedLog",
                                                               "A simulated drive: a sequence of LogEntry.");
  type.def("__len__", [](const SimulatedLog& log) { return log.entries.size(); });
  type.def(
      "__getitem__",
      [](const SimulatedLog& log, py::ssize_t i) -> const LogEntry& {
        const auto n = static_cast<py::ssize_t>(log.entries.size());
        if (i < -n || i >= n) throw py::index_error("there are " + std::to_string(n) + " scans");
        return log.entries[static_cast<std::size_t>(i < 0 ? i + n : i)];
      },
      py::arg("index"), py::return_value_policy::reference_internal);
  type.def_property_readonly(
      "truth",
      [](const SimulatedLog& log) { return pose_array(log.truth, [](const StampedPose& p) { return p.pose; }); },
      "ndarray, shape (n, 3): T_world_laser at each scan's stamp: x, y [m], theta [rad].");
  type.def_property_readonly(
      "stamps",
      [](const SimulatedLog& log) {
        return value_array<double>(log.truth, [](const StampedPose& p) { return stamp_to_seconds(p.stamp); });
      },
      "ndarray, shape (n,): [s].");
  type.def("save", &save, py::arg("path"), py::call_guard<py::gil_scoped_release>(),
           "Writes the scan log, and PATH.truth.tum beside it.");
  type.def("__repr__",
           [](const SimulatedLog& log) { return fmt::format("<SimulatedLog of {} scans>", log.entries.size()); });
  module.def("simulate", &simulate, py::arg("world") = "flat", py::kw_only(), py::arg("sensor") = "rplidar-a1",
             py::arg("path") = "tour", py::arg("seed") = 1, py::arg("motion") = true, kSimulateDoc);
}

}  // namespace phasescan::python
