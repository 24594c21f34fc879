// Matching: one pair, many scans against one reference, prepared references.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <memory>
#include <mutex>

#include "bind.hpp"
#include "core/parallel.hpp"
#include "match_results.hpp"
#include "methods/any_matcher.hpp"
#include "options.hpp"
#include "phasescan/match/result.hpp"

namespace phasescan::python {
namespace {

bool same_options(const MatcherOptions& a, const MatcherOptions& b) {
  const auto numbers_of = [](const MatcherOptions& options) {
    std::vector<double> out;
    out.reserve(128);
    MatcherOptions::visit_sections(options, [&](std::string_view, const auto& section) {
      std::decay_t<decltype(section)>::visit(section, [&](std::string_view, const auto& value, const OptionInfo&) {
        out.push_back(static_cast<double>(value));
      });
    });
    return out;
  };
  return numbers_of(a) == numbers_of(b);
}

MatcherOptions matcher_options(const std::string& method, const py::object& options, const py::kwargs& keywords) {
  MatcherOptions made = options_from<MatcherOptions>(options, keywords);
  // "global" is the default of the keyword: options that name another method keep it.
  if (!method.empty() && (method != "global" || options.is_none())) {
    try {
      made.match.method = enum_from_word<MatchMethod>(method);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(std::string("method: ") + error.what());
    }
  }
  made.validate();
  return made;
}

/// A reference scan, prepared, with the options it was prepared with.
struct PyReference {
  MatcherOptions options;
  AnyReference prepared;
  std::size_t beams = 0;
};

/// A matcher that several threads of Python may hold: one works at a time.
struct PyMatcher {
  explicit PyMatcher(const MatcherOptions& options) : matcher(options) {}
  AnyMatcher matcher;
  std::mutex mutex;
};

/// This thread's matcher for `match`: made once for options that stay.
AnyMatcher& matcher_of_thread(const MatcherOptions& options) {
  thread_local std::unique_ptr<AnyMatcher> matcher;
  if (!matcher || !same_options(matcher->options(), options)) matcher = std::make_unique<AnyMatcher>(options);
  return *matcher;
}

MatchHints hints_from(const py::object& guess, const py::object& reference_twist, const py::object& scan_twist) {
  return {to_optional_pose(guess, "guess"), to_twist(reference_twist, "reference_twist"),
          to_twist(scan_twist, "scan_twist")};
}

MatchResult match_prepared(AnyMatcher& matcher, const PyReference& reference, const Scan& scan,
                           const MatchHints& hints) {
  if (!same_options(matcher.options(), reference.options))
    throw std::invalid_argument("reference: was prepared with other options; expected the same as for the match");
  return matcher.match(reference.prepared, scan, hints);
}

MatchResult match_one(const py::object& reference, const py::object& scan, double angle_min,
                      std::optional<double> angle_increment, double range_min, std::optional<double> range_max,
                      const py::object& guess, const std::string& method, const py::object& reference_twist,
                      const py::object& scan_twist, const py::object& options, const py::kwargs& keywords) {
  const ArrayGeometry geometry{angle_min, angle_increment, range_min, range_max};
  const ScanArgument now(scan, geometry, "scan");
  const MatchHints hints = hints_from(guess, reference_twist, scan_twist);
  if (py::isinstance<PyReference>(reference)) {
    const auto& prepared = reference.cast<const PyReference&>();
    const bool own = options.is_none() && keywords.empty() && (method.empty() || method == "global");
    const MatcherOptions asked = own ? prepared.options : matcher_options(method, options, keywords);
    const py::gil_scoped_release release;
    return match_prepared(matcher_of_thread(asked), prepared, *now, hints);
  }
  const ScanArgument before(reference, geometry, "reference");
  const MatcherOptions asked = matcher_options(method, options, keywords);
  const py::gil_scoped_release release;
  return matcher_of_thread(asked).match(*before, *now, hints);
}

/// Scans of a list, or of the rows of an array.
std::vector<Scan> scans_from(const py::object& object, const ArrayGeometry& geometry) {
  std::vector<Scan> scans;
  if (py::isinstance<py::array>(object)) {
    using Rows = py::array_t<float, py::array::c_style | py::array::forcecast>;
    const Rows rows = Rows::ensure(object);
    if (!rows || rows.ndim() != 2)
      throw std::invalid_argument("scans: expected an array of shape (scans, beams), or a list of scans");
    const auto beams = static_cast<std::size_t>(rows.shape(1));
    for (py::ssize_t i = 0; i < rows.shape(0); ++i)
      scans.push_back(make_scan({rows.data(i, 0), beams}, geometry.of(beams)));
    return scans;
  }
  for (const py::handle item : object) scans.push_back(*ScanArgument(item, geometry, "scans"));
  return scans;
}

MatchResults match_each(const std::vector<Scan>& scans, const PyReference* prepared, const Scan* reference,
                        const MatcherOptions& options, std::size_t threads) {
  std::vector<std::unique_ptr<AnyMatcher>> matchers;
  const std::size_t workers = std::min(threads, std::max<std::size_t>(scans.size(), 1));
  for (std::size_t k = 0; k < workers; ++k) matchers.push_back(std::make_unique<AnyMatcher>(options));
  const AnyReference own = prepared != nullptr ? prepared->prepared : matchers.front()->prepare(*reference);
  MatchResults out{std::vector<MatchResult>(scans.size())};
  // Each scan is matched alone, so which thread takes it cannot change its answer.
  parallel_for(scans.size(), workers,
               [&](std::size_t i, std::size_t worker) { out.results[i] = matchers[worker]->match(own, scans[i]); });
  return out;
}

MatchResults match_many_scans(const py::object& reference, const py::object& scans, double angle_min,
                              std::optional<double> angle_increment, double range_min, std::optional<double> range_max,
                              const std::string& method, int threads, const py::object& options,
                              const py::kwargs& keywords) {
  if (threads < 1) throw std::invalid_argument("threads: must be 1 or more");
  const ArrayGeometry geometry{angle_min, angle_increment, range_min, range_max};
  const std::vector<Scan> all = scans_from(scans, geometry);
  const PyReference* prepared =
      py::isinstance<PyReference>(reference) ? &reference.cast<const PyReference&>() : nullptr;
  MatcherOptions asked;
  if (prepared != nullptr && options.is_none() && keywords.empty()) {
    asked = prepared->options;
  } else {
    asked = matcher_options(method, options, keywords);
    if (prepared != nullptr && !same_options(asked, prepared->options))
      throw std::invalid_argument("reference: was prepared with other options; expected the same as for the match");
  }
  std::optional<ScanArgument> raw;
  if (prepared == nullptr) raw.emplace(reference, geometry, "reference");
  const Scan* const before = raw ? &**raw : nullptr;
  const py::gil_scoped_release release;
  return match_each(all, prepared, before, asked, static_cast<std::size_t>(threads));
}

void bind_matcher(py::module_& module) {
  py::class_<PyReference> reference(module, "Reference",
                                    R"(A reference scan with all that is prepared of it, for many matches.

Parameters
----------
scan : Scan or array_like, shape (n,)
twist : velocity, optional
    Of the sensor during the scan; the motion is taken out of it.
method : str
options, **options
    As for `match`.)");
  reference.def(py::init([](const py::object& scan, const py::object& twist, const std::string& method,
                            const py::object& options, const py::kwargs& keywords) {
                  const ScanArgument raw(scan, {}, "scan");
                  const MatcherOptions made = matcher_options(method, options, keywords);
                  const Twist2 motion = to_twist(twist, "twist");
                  const py::gil_scoped_release release;
                  return PyReference{made, AnyMatcher(made).prepare(*raw, motion), (*raw).size()};
                }),
                py::arg("scan"), py::kw_only(), py::arg("twist") = py::none(), py::arg("method") = "",
                py::arg("options") = py::none());
  reference.def_property_readonly(
      "options", [](const PyReference& r) { return r.options; }, "MatchOptions.");
  reference.def("__repr__", [](const PyReference& r) {
    return fmt::format("<Reference of {} beams, method {}>", r.beams, to_string(r.options.match.method));
  });

  py::class_<PyMatcher> type(module, "Matcher", R"(Matches scans; keeps its buffers between matches.

Parameters
----------
method : str
    global, icp, ndt, fft, fft-icp1 or fft-icp2.
options, **options
    As for `match`.)");
  type.def(py::init([](const std::string& method, const py::object& options, const py::kwargs& keywords) {
             return std::make_unique<PyMatcher>(matcher_options(method, options, keywords));
           }),
           py::arg("method") = "", py::kw_only(), py::arg("options") = py::none());
  type.def(
      "match",
      [](PyMatcher& self, const py::object& before, const py::object& now, const py::object& guess,
         const py::object& reference_twist, const py::object& scan_twist) {
        const ScanArgument scan(now, {}, "scan");
        const MatchHints hints = hints_from(guess, reference_twist, scan_twist);
        if (py::isinstance<PyReference>(before)) {
          const auto& prepared = before.cast<const PyReference&>();
          const py::gil_scoped_release release;
          const std::lock_guard lock(self.mutex);
          return match_prepared(self.matcher, prepared, *scan, hints);
        }
        const ScanArgument raw(before, {}, "reference");
        const py::gil_scoped_release release;
        const std::lock_guard lock(self.mutex);
        return self.matcher.match(*raw, *scan, hints);
      },
      py::arg("reference"), py::arg("scan"), py::kw_only(), py::arg("guess") = py::none(),
      py::arg("reference_twist") = py::none(), py::arg("scan_twist") = py::none(),
      "MatchResult: As `match` with this matcher's options.");
  type.def(
      "prepare",
      [](PyMatcher& self, const py::object& scan, const py::object& twist) {
        const ScanArgument raw(scan, {}, "scan");
        const Twist2 motion = to_twist(twist, "twist");
        const py::gil_scoped_release release;
        const std::lock_guard lock(self.mutex);
        return PyReference{self.matcher.options(), self.matcher.prepare(*raw, motion), (*raw).size()};
      },
      py::arg("scan"), py::kw_only(), py::arg("twist") = py::none(), "Reference: Prepared once, for many matches.");
  type.def_property_readonly(
      "options", [](const PyMatcher& self) { return self.matcher.options(); }, "MatchOptions.");
  type.def("__repr__", [](const PyMatcher& self) {
    return fmt::format("<Matcher, method {}>", to_string(self.matcher.options().match.method));
  });
}

constexpr const char* kMatchDoc =
    R"(match(reference, scan, *, angle_min=0.0, angle_increment=None, range_min=0.0, range_max=None,
      guess=None, method='global', reference_twist=None, scan_twist=None, options=None, **keywords)
--

Finds the pose of a scan in the frame of another, with no first guess.

Parameters
----------
reference : Scan, Reference or array_like, shape (n,)
    Ranges [m] of one turn, or a scan. 0, nan, inf and what lies outside the limits are missing.
scan : Scan or array_like, shape (n,)
angle_min : float
    Of arrays: direction of the first beam [rad], counter-clockwise from x forward.
angle_increment : float, optional
    Of arrays: from beam to beam [rad]; a full turn, ``2 * pi / n``, unless given.
range_min, range_max : float, optional
    Of arrays: limits of the sensor [m]; 0 and None are unknown.
guess : pose, optional
    T_ref_scan to start from; none is needed.
method : str
    global, or icp, ndt, fft, fft-icp1, fft-icp2 to compare.
reference_twist, scan_twist : velocity, optional
    Of the sensor during the scans; the motion is taken out of them.
options : dict or MatchOptions, optional
**options
    Options by name, or a section with a dict; an unknown one names the nearest.

Returns
-------
MatchResult
    True where it is usable. Its pose is T_ref_scan: ``p_ref = R(theta) p_scan + (x, y)`` [m, rad].

Raises
------
OptionError, ValueError
    For options that do not exist or are out of bounds. A hopeless scan is a status, never an exception.)";

constexpr const char* kManyDoc =
    R"(match_many(reference, scans, *, angle_min=0.0, angle_increment=None, range_min=0.0, range_max=None,
           method='global', threads=1, options=None, **keywords)
--

Matches many scans against one reference.

Parameters
----------
reference : Scan, Reference or array_like, shape (n,)
scans : array_like, shape (k, n), or iterable of Scan
    Ranges [m], a row a scan.
threads : int
    The answers are the same for any number.
angle_min, angle_increment, range_min, range_max, method, options, **options
    As for `match`.

Returns
-------
MatchResults
    Of length k.)";

}  // namespace

void bind_match(py::module_& module) {
  bind_match_results(module);
  bind_matcher(module);
  module.def("match", &match_one, py::arg("reference"), py::arg("scan"), py::kw_only(), py::arg("angle_min") = 0.0,
             py::arg("angle_increment") = py::none(), py::arg("range_min") = 0.0, py::arg("range_max") = py::none(),
             py::arg("guess") = py::none(), py::arg("method") = "global", py::arg("reference_twist") = py::none(),
             py::arg("scan_twist") = py::none(), py::arg("options") = py::none(), kMatchDoc);
  module.def("match_many", &match_many_scans, py::arg("reference"), py::arg("scans"), py::kw_only(),
             py::arg("angle_min") = 0.0, py::arg("angle_increment") = py::none(), py::arg("range_min") = 0.0,
             py::arg("range_max") = py::none(), py::arg("method") = "global", py::arg("threads") = 1,
             py::arg("options") = py::none(), kManyDoc);
}

}  // namespace phasescan::python
