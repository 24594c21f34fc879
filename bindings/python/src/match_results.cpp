#include "match_results.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>

namespace phasescan::python {
namespace {

std::string result_text(const MatchResult& r) {
  const std::string confidence = r.confidence ? fmt::format(", confidence {:.3f}", *r.confidence) : "";
  return fmt::format("<MatchResult {} {}{}{}>",
                     r.usable ? "usable" : "not usable:", r.usable ? "at" : to_string(r.status),
                     " " + pose_text(r.T_ref_scan), confidence);
}

py::dict times_of(const MatchResult& r) {
  const MatchTimes& ms = r.diagnostics.ms;
  py::dict out;
  out["total"] = ms.total;
  out["image"] = ms.image;
  out["missing"] = ms.missing;
  out["rotation"] = ms.rotation;
  out["translation"] = ms.translation;
  out["refine"] = ms.refine;
  return out;
}

void bind_result(py::module_& module) {
  py::class_<MatchAlternative> other(module, "MatchAlternative", "Another pose that explains the scans.");
  const auto other_pose = [](const MatchAlternative& a) { return a.T_ref_scan; };
  other.def_property_readonly("T_ref_scan", other_pose, "Pose2: As of MatchResult [m, rad].");
  other.def_property_readonly("pose", other_pose, "Pose2: T_ref_scan.");
  other.def_property_readonly(
      "confidence", [](const MatchAlternative& a) { return a.confidence; }, "float: 0..1.");
  other.def("__repr__", [](const MatchAlternative& a) {
    return fmt::format("<MatchAlternative {} confidence {:.3f}>", pose_text(a.T_ref_scan), a.confidence);
  });

  py::class_<MatchResult> type(module, "MatchResult", "The answer of a match: never a bare pose.");
  const auto pose = [](const MatchResult& r) { return r.T_ref_scan; };
  type.def_property_readonly(
      "T_ref_scan", pose, "Pose2: ``p_ref = R(theta) p_scan + (x, y)`` [m, rad]: the best pose found, usable or not.");
  type.def_property_readonly("pose", pose, "Pose2: T_ref_scan.");
  type.def_property_readonly(
      "usable", [](const MatchResult& r) { return r.usable; }, "bool: The pose may be acted on.");
  const auto status = [](const MatchResult& r) { return std::string(to_string(r.status)); };
  type.def_property_readonly("status", status, "str: Why it ended so: converged, no points, ambiguous, ...");
  type.def_property_readonly("reason", status, "str: status.");
  type.def_property_readonly(
      "ambiguous", [](const MatchResult& r) { return r.ambiguous; },
      "bool: Another pose explains the scans as well (symmetric room, bare corridor).");
  type.def_property_readonly(
      "covariance", [](const MatchResult& r) { return matrix_array(r.covariance); },
      "ndarray, shape (3, 3): Of (x, y, theta) in the reference's frame [m^2, m rad, rad^2], capped at 1e6.");
  type.def_property_readonly(
      "confidence", [](const MatchResult& r) { return r.confidence; },
      "float or None: Probability of being within 0.1 m and 3 deg; None for methods without calibration.");
  type.def_property_readonly(
      "overlap", [](const MatchResult& r) { return r.overlap; }, "float: Share of hits with a partner, 0..1.");
  type.def_property_readonly(
      "alternatives", [](const MatchResult& r) { return r.alternatives; }, "list of MatchAlternative: Best first.");
  type.def_property_readonly(
      "rotation_source", [](const MatchResult& r) { return std::string(to_string(r.diagnostics.rotation_source)); },
      "str: Which stage gave the rotation.");
  type.def_property_readonly(
      "violation", [](const MatchResult& r) { return r.diagnostics.violation; },
      "float: Share of hits where the other scan looked through, 0..1.");
  type.def_property_readonly("ms", &times_of, "dict of float: CPU time by stage [ms].");
  type.def("__bool__", [](const MatchResult& r) { return r.usable; });
  type.def("__repr__", &result_text);
}

void bind_results(py::module_& module) {
  py::class_<MatchResults> type(module, "MatchResults", "Answers of `match_many`, in the order of its scans.");
  type.def("__len__", [](const MatchResults& r) { return r.results.size(); });
  type.def(
      "__getitem__",
      [](const MatchResults& r, py::ssize_t i) {
        const auto n = static_cast<py::ssize_t>(r.results.size());
        if (i < -n || i >= n) throw py::index_error("there are " + std::to_string(n) + " results");
        return r.results[static_cast<std::size_t>(i < 0 ? i + n : i)];
      },
      py::arg("index"));
  type.def_property_readonly(
      "poses",
      [](const MatchResults& r) { return pose_array(r.results, [](const MatchResult& m) { return m.T_ref_scan; }); },
      "ndarray, shape (n, 3): x, y [m], theta [rad] of T_ref_scan.");
  type.def_property_readonly(
      "usable",
      [](const MatchResults& r) { return value_array<bool>(r.results, [](const MatchResult& m) { return m.usable; }); },
      "ndarray, shape (n,), bool.");
  type.def_property_readonly(
      "confidence",
      [](const MatchResults& r) {
        return value_array<double>(r.results, [](const MatchResult& m) { return m.confidence.value_or(std::nan("")); });
      },
      "ndarray, shape (n,): 0..1, nan for methods without calibration.");
  type.def_property_readonly(
      "covariances",
      [](const MatchResults& r) {
        py::array_t<double> out({static_cast<py::ssize_t>(r.results.size()), py::ssize_t{3}, py::ssize_t{3}});
        auto cell = out.mutable_unchecked<3>();
        for (std::size_t i = 0; i < r.results.size(); ++i) {
          for (int k = 0; k < 9; ++k)
            cell(static_cast<py::ssize_t>(i), k / 3, k % 3) = r.results[i].covariance(k / 3, k % 3);
        }
        return out;
      },
      "ndarray, shape (n, 3, 3): [m^2, m rad, rad^2], in the reference's frame.");
  type.def("__repr__", [](const MatchResults& r) {
    const auto usable =
        std::count_if(r.results.begin(), r.results.end(), [](const MatchResult& m) { return m.usable; });
    return fmt::format("<MatchResults: {} of {} usable>", usable, r.results.size());
  });
}

}  // namespace

void bind_match_results(py::module_& module) {
  bind_result(module);
  bind_results(module);
}

}  // namespace phasescan::python
