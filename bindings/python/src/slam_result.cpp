// The finished run as arrays.
#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "bind.hpp"
#include "io/file.hpp"
#include "io/tum.hpp"
#include "phasescan/slam/result.hpp"
#include "slam.hpp"

namespace phasescan::python {
namespace {

using Result = std::shared_ptr<SlamResult>;

py::dict loops_dict(const SlamResult& result) {
  py::dict out;
  LoopCounts counts = result.loops;
  LoopCounts::visit(counts, [&](const char* name, std::size_t value) { out[name] = value; });
  return out;
}

py::dict oddities_dict(const SlamResult& result) {
  py::dict out;
  for (const auto& [kind, oddity] : result.oddities) {
    py::dict row;
    row["count"] = oddity.count;
    row["damage"] = oddity.damage;
    row["first"] = oddity.first;
    row["what"] = oddity.what;
    out[py::str(kind)] = row;
  }
  return out;
}

py::list findings_list(const SlamResult& result) {
  py::list out;
  for (const RunFinding& finding : result.findings) {
    py::dict row;
    row["kind"] = finding.kind;
    row["count"] = finding.count;
    row["first_stamp"] = stamp_to_seconds(finding.first_stamp);
    row["what"] = finding.what;
    out.append(row);
  }
  return out;
}

py::list edges_list(const SlamResult& result) {
  py::list out;
  for (const MapEdge& edge : result.edges) {
    py::dict row;
    row["from"] = edge.from;
    row["to"] = edge.to;
    row["T_from_to"] = edge.T_from_to;
    row["information"] = matrix_array(edge.information);
    row["loop"] = edge.loop;
    row["enabled"] = edge.enabled;
    out.append(row);
  }
  return out;
}

void bind_verdict(py::module_& module) {
  py::class_<RunVerdict> type(module, "RunVerdict",
                              "What a run says of itself; its reasons are the findings of the SlamResult.");
  type.def_property_readonly(
      "verdict", [](const RunVerdict& v) { return std::string(to_string(v.verdict)); },
      "str: good (probability from 0.97 on), doubtful, or failed (up to 0.2, or most scans are on no map).");
  type.def_property_readonly(
      "probability", [](const RunVerdict& v) { return v.probability; },
      "float: That the trajectory is within 0.2 m or 1 % of the way (absolute error, root mean square).");
  type.def_property_readonly(
      "evidence", [](const RunVerdict& v) { return v.evidence; }, "dict of float: Numbers that it rests on.");
  type.def("__str__", [](const RunVerdict& v) { return std::string(to_string(v.verdict)); });
  type.def(
      "__eq__", [](const RunVerdict& v, const std::string& word) { return word == to_string(v.verdict); },
      py::is_operator(), "Whether its word is this one: ``result.verdict == 'good'``.");
  type.def("__repr__", [](const RunVerdict& v) {
    return fmt::format("<RunVerdict {}, probability {:.3f}>", to_string(v.verdict), v.probability);
  });
}

void write_tum(const SlamResult& result, const std::filesystem::path& path) {
  std::vector<StampedPose> poses;
  for (const ScanResult& scan : result.scans) poses.push_back({scan.stamp, scan.T_map_base});
  write_file(path.string(), format_tum(poses));
}

void bind_scan_values(py::class_<SlamResult, Result>& type) {
  type.def_property_readonly(
      "stamps",
      [](const SlamResult& r) {
        return value_array<double>(r.scans, [](const ScanResult& s) { return stamp_to_seconds(s.stamp); });
      },
      "ndarray, shape (n,): Of each scan [s].");
  type.def_property_readonly(
      "stamps_ns",
      [](const SlamResult& r) {
        return value_array<std::int64_t>(r.scans, [](const ScanResult& s) { return s.stamp; });
      },
      "ndarray, shape (n,), int64: The same [ns], exact.");
  type.def_property_readonly(
      "poses",
      [](const SlamResult& r) { return pose_array(r.scans, [](const ScanResult& s) { return s.T_map_base; }); },
      "ndarray, shape (n, 3): T_map_base of each scan: x, y [m], theta [rad].");
  type.def_property_readonly(
      "odometry_poses",
      [](const SlamResult& r) { return pose_array(r.scans, [](const ScanResult& s) { return s.T_odom_base; }); },
      "ndarray, shape (n, 3): T_odom_base of each scan, as tracking alone saw it.");
  type.def_property_readonly(
      "status",
      [](const SlamResult& r) {
        py::list out;
        for (const ScanResult& s : r.scans) out.append(std::string(to_string(s.status)));
        return out;
      },
      "list of str: initialising, ok, degraded, ambiguous or lost, of each scan.");
  type.def_property_readonly(
      "left_out",
      [](const SlamResult& r) { return value_array<bool>(r.scans, [](const ScanResult& s) { return s.left_out; }); },
      "ndarray, shape (n,), bool: Scans that fit neither those before nor those after them.");
  type.def_property_readonly(
      "on_map",
      [](const SlamResult& r) { return value_array<bool>(r.scans, [](const ScanResult& s) { return s.on_map; }); },
      "ndarray, shape (n,), bool: Scans in the piece that the map is drawn of.");
}

}  // namespace

void bind_slam_result(py::module_& module) {
  bind_verdict(module);
  py::class_<SlamResult, Result> type(module, "SlamResult", "The finished run: poses, graph, map, and what was odd.");
  bind_scan_values(type);
  type.def_property_readonly(
      "keyframe_poses",
      [](const SlamResult& r) { return pose_array(r.keyframes, [](const MapKeyframe& k) { return k.T_map_base; }); },
      "ndarray, shape (m, 3): T_map_base of each keyframe: x, y [m], theta [rad].");
  type.def_property_readonly(
      "keyframe_scans",
      [](const SlamResult& r) {
        return value_array<std::int64_t>(r.keyframes, [](const MapKeyframe& k) { return k.scan; });
      },
      "ndarray, shape (m,), int64: Number of each keyframe's scan.");
  type.def_property_readonly("edges", &edges_list, "list of dict: from, to, T_from_to, information, loop, enabled.");
  type.def_property_readonly(
      "map", [](const Result& r) { return std::shared_ptr<TrinaryMap>(r, &r->map).get(); },
      py::return_value_policy::reference_internal, "TrinaryMap.");
  type.def_property_readonly("loops", &loops_dict, "dict of int: compared, found, accepted, ...");
  type.def_property_readonly("oddities", &oddities_dict, "dict of dict: What is odd about the input, by kind.");
  type.def_property_readonly(
      "findings", &findings_list,
      "list of dict: kind, count, first_stamp [s], what: what speaks against the map or was done "
      "to save it, strongest first.");
  type.def_property_readonly(
      "verdict", [](const SlamResult& r) { return r.verdict; },
      "RunVerdict: good, doubtful or failed, with a probability; its reasons are the findings.");
  type.def_property_readonly(
      "pieces", [](const SlamResult& r) { return r.pieces; }, "int: That nothing ties.");
  type.def_property_readonly(
      "parts",
      [](const SlamResult& r) {
        std::vector<Result> parts;
        for (const SlamResult& part : r.parts) parts.push_back(std::make_shared<SlamResult>(part));
        return parts;
      },
      "list of SlamResult: Where nothing ties some drives to others; else empty.");
  type.def_property_readonly("scans_left_out", &SlamResult::scans_left_out, "int: Left out as bad, or not on the map.");
  type.def("write_tum", &write_tum, py::arg("path"), "Writes the trajectory as `stamp x y z qx qy qz qw` lines.");
  type.def("__len__", [](const SlamResult& r) { return r.scans.size(); });
  type.def("__repr__", [](const SlamResult& r) {
    return fmt::format("<SlamResult {} of {} scans, {} keyframes, {} loops, map of {:.1f} m x {:.1f} m>",
                       to_string(r.verdict.verdict), r.scans.size(), r.keyframes.size(), r.loops.accepted,
                       r.map.width * r.map.resolution_m, r.map.height * r.map.resolution_m);
  });
}

}  // namespace phasescan::python
