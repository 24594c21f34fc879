// How good a trajectory is.
#include <pybind11/stl.h>

#include <filesystem>

#include "bind.hpp"
#include "eval/relations.hpp"
#include "eval/trajectory_error.hpp"
#include "io/tum.hpp"
#include "phasescan/io/error.hpp"
#include "phasescan/slam/result.hpp"

namespace phasescan::python {
namespace {

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Poses of a TUM file, of a SlamResult, or of (stamps, poses).
std::vector<StampedPose> poses_of(const py::object& object, const char* name) {
  std::vector<StampedPose> out;
  if (py::isinstance<SlamResult>(object)) {
    for (const ScanResult& scan : object.cast<const SlamResult&>().scans) out.push_back({scan.stamp, scan.T_map_base});
    return out;
  }
  if (py::isinstance<py::str>(object) || py::hasattr(object, "__fspath__"))
    return read_tum(py::str(py::module_::import("os").attr("fspath")(object)));
  if (!py::isinstance<py::tuple>(object) || py::len(object) != 2)
    throw std::invalid_argument(std::string(name) +
                                ": expected a TUM file, a SlamResult, or (stamps [s], poses of shape (n, 3)), got " +
                                type_name(object));
  const auto pair = py::reinterpret_borrow<py::tuple>(object);
  const Doubles stamps = Doubles::ensure(pair[0]), poses = Doubles::ensure(pair[1]);
  if (!stamps || !poses || stamps.ndim() != 1 || poses.ndim() != 2 || poses.shape(1) != 3 ||
      poses.shape(0) != stamps.shape(0)) {
    PyErr_Clear();
    throw std::invalid_argument(std::string(name) + ": expected stamps of shape (n,) and poses of shape (n, 3)");
  }
  const auto pose = poses.unchecked<2>();
  for (py::ssize_t i = 0; i < stamps.shape(0); ++i)
    out.push_back({stamp_from_seconds(stamps.at(i)), {pose(i, 0), pose(i, 1), wrap_angle(pose(i, 2))}});
  return out;
}

/// Of nothing there is no mean: a zero would read as perfect.
py::dict stats_dict(const std::vector<double>& errors, double scale = 1.0) {
  const ErrorStats s = error_stats(errors);
  py::dict out;
  out["n"] = s.n;
  const std::pair<const char*, double> values[] = {{"rmse", s.rmse}, {"mean", s.mean}, {"median", s.median},
                                                   {"std", s.std},   {"min", s.min},   {"max", s.max}};
  for (const auto& [name, value] : values)
    out[name] = s.n == 0 ? py::object(py::none()) : py::object(py::float_(scale * value));
  return out;
}

py::dict against_reference(const std::vector<StampedPose>& trajectory, const std::vector<StampedPose>& reference,
                           double max_gap_s, bool align, double delta, const std::string& delta_unit) {
  if (delta_unit != "f" && delta_unit != "m")
    throw std::invalid_argument("delta_unit: is '" + delta_unit + "'; expected f (frames) or m");
  const AssociatedPoses pairs = associate(trajectory, reference, max_gap_s);
  if (pairs.estimate.empty())
    throw std::invalid_argument("reference: no pose within " + std::to_string(max_gap_s) +
                                " s of one of the trajectory; expected the same clock in both");
  const RelativeErrors rpe =
      relative_pose_errors(pairs, delta, delta_unit == "m" ? StepUnit::kMetres : StepUnit::kFrames);
  const double deg = rad_to_deg(1.0);
  py::dict out;
  out["poses"] = trajectory.size();
  out["reference_poses"] = reference.size();
  out["pairs"] = pairs.estimate.size();
  out["aligned"] = align;
  out["ate_m"] = stats_dict(absolute_trajectory_errors(pairs, align));
  out["translation_m"] = stats_dict(absolute_trajectory_errors(pairs, align));
  out["rotation_deg"] = stats_dict(absolute_rotation_errors(pairs, align), deg);
  out["rpe_m"] = stats_dict(rpe.translation);
  out["rpe_deg"] = stats_dict(rpe.rotation, deg);
  return out;
}

py::dict evaluate(const py::object& trajectory, const py::object& reference, const py::object& relations,
                  std::optional<double> max_gap_s, bool align, double delta, const std::string& delta_unit,
                  const py::object& T_base_laser) {
  if (reference.is_none() == relations.is_none())
    throw std::invalid_argument("reference: expected one of reference and relations");
  const std::vector<StampedPose> poses = poses_of(trajectory, "trajectory");
  if (!reference.is_none())
    return against_reference(poses, poses_of(reference, "reference"), max_gap_s.value_or(0.01), align, delta,
                             delta_unit);
  const std::string path = py::str(py::module_::import("os").attr("fspath")(relations));
  const RelationErrors errors = relation_errors(
      poses, read_relations(path), T_base_laser.is_none() ? Pose2{} : to_pose(T_base_laser, "T_base_laser"),
      max_gap_s.value_or(0.01));
  py::dict out;
  out["relations"] = errors.relations;
  out["answered"] = errors.translation.size();
  out["unanswered"] = errors.unanswered;
  out["translation_m"] = stats_dict(errors.translation);
  out["rotation_deg"] = stats_dict(errors.rotation, rad_to_deg(1.0));
  return out;
}

constexpr const char* kEvaluateDoc =
    R"(evaluate(trajectory, reference=None, *, relations=None, max_gap_s=None, align=True, delta=1.0, delta_unit='f',
         T_base_laser=None)
--

Says how good a trajectory is, as `phasescan eval` does.

Parameters
----------
trajectory : path, SlamResult, or (stamps, poses)
    A TUM file, or stamps of shape (n,) [s] and poses of shape (n, 3) [m, rad].
reference : the same, optional
    What it is compared with; poses pair by time.
relations : path, optional
    Instead: relative poses that people verified, `time_a time_b x y z roll pitch yaw` a line.
max_gap_s : float, optional
    Poses that belong together are no farther apart than this [s]; 0.01.
align : bool
    Lay the trajectory onto the reference first (least squares, no scale).
delta, delta_unit : float, str
    Step of the relative pose error: frames (f) or metres (m).
T_base_laser : pose, optional
    With relations, which are between poses of the laser.

Returns
-------
dict
    ate_m, translation_m, rotation_deg, rpe_m, rpe_deg: each n, rmse, mean, median, std, min, max; with relations
    answered, unanswered, translation_m, rotation_deg.)";

}  // namespace

void bind_evaluation(py::module_& module) {
  module.def("evaluate", &evaluate, py::arg("trajectory"), py::arg("reference") = py::none(), py::kw_only(),
             py::arg("relations") = py::none(), py::arg("max_gap_s") = py::none(), py::arg("align") = true,
             py::arg("delta") = 1.0, py::arg("delta_unit") = "f", py::arg("T_base_laser") = py::none(), kEvaluateDoc);
}

}  // namespace phasescan::python
