// What the fleet compares: views of keyframes, their descriptors, and matches of two views. Not for users.
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "bind.hpp"
#include "phasescan/match/scan_matcher.hpp"
#include "phasescan/slam/state.hpp"
#include "scan/points.hpp"
#include "slam/backend.hpp"
#include "slam/place_check.hpp"
#include "slam/place_descriptor.hpp"
#include "slam/place_index.hpp"
#include "slam/place_search.hpp"
#include "slam/slam_state.hpp"

namespace phasescan::python {
namespace {

constexpr int kViewBeams = 360;
constexpr int kViewNodes = 6;        // keyframes before it that a view is made of as well
constexpr double kViewApartM = 0.4;  // so their number grows with the places, not with the time spent in them
constexpr double kMostSigmaM = 0.1;
// Share of the hits that may lie where the other view looked through, of a match that says what others have said.
constexpr double kMostViolationAgreeing = 0.1;
constexpr std::int32_t kNumbersCount = 3;  // as PlaceIndex weighs them
// Squared distance of descriptors beyond which they are of different places, as PlaceSearch has it.
constexpr auto kMostDistance = static_cast<std::int64_t>(kDescriptorLength * kDescriptorLength);

using Floats = py::array_t<float, py::array::c_style | py::array::forcecast>;
using Numbers = py::array_t<std::int8_t, py::array::c_style>;
using Turning = py::array_t<std::uint8_t, py::array::c_style>;
using Rows = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;

struct View {
  Pose2 T_map_view;
  Scan scan;
  PlaceDescriptor descriptor;
};

/// Views at keyframes of the largest piece of a saved run's map.
std::vector<View> views_of(const SavedRun& run) {
  const SlamState::Data& data = run.state.data();
  Backend backend(run.options, data.backend);
  if (!data.batch.empty()) backend.add_batch(data.batch);
  const MapPieces pieces = backend.pieces();
  PlaceDescriber describer;
  ScanPoints points;
  std::vector<View> views;
  for (std::size_t i = 0; i < backend.keyframes().size(); ++i) {
    const Pose2& here = backend.poses()[i];
    const auto near = [&](const View& view) { return translation_distance(view.T_map_view, here) < kViewApartM; };
    if (!pieces.in_largest(i) || std::any_of(views.begin(), views.end(), near)) continue;
    View view{here, view_at(backend.keyframes(), backend.poses(), static_cast<int>(i), kViewNodes), {}};
    scan_to_points(view.scan, points);
    view.descriptor = describer.describe(points.x, points.y);
    views.push_back(std::move(view));
  }
  return views;
}

py::dict session_views(const std::string& path) {
  std::vector<View> views;
  {
    const py::gil_scoped_release release;
    views = views_of(read_state(path));
  }
  const auto n = static_cast<py::ssize_t>(views.size());
  py::array_t<float> ranges({n, py::ssize_t{kViewBeams}});
  Numbers numbers({n, static_cast<py::ssize_t>(kDescriptorSize)});
  Turning turning({n, static_cast<py::ssize_t>(kTurningSize)});
  for (py::ssize_t i = 0; i < n; ++i) {
    const View& view = views[static_cast<std::size_t>(i)];
    for (py::ssize_t k = 0; k < kViewBeams; ++k)
      ranges.mutable_at(i, k) = raw_range(view.scan, static_cast<std::size_t>(k));
    std::copy(view.descriptor.numbers.begin(), view.descriptor.numbers.end(), numbers.mutable_data(i, 0));
    std::copy(view.descriptor.turning.begin(), view.descriptor.turning.end(), turning.mutable_data(i, 0));
  }
  py::dict out;
  out["poses"] = pose_array(views, [](const View& view) { return view.T_map_view; });
  out["ranges"] = ranges;
  out["numbers"] = numbers;
  out["turning"] = turning;
  return out;
}

Scan view_scan(const float* ranges) {
  return make_scan({ranges, kViewBeams}, {0.0, kTwoPi / kViewBeams, 0.0, 0.0});
}

double most_sigma(const Eigen::Matrix3d& covariance) {
  const double half = 0.5 * (covariance(0, 0) - covariance(1, 1));
  return std::sqrt(0.5 * (covariance(0, 0) + covariance(1, 1)) + std::hypot(half, covariance(0, 1)));
}

/// Matches views a[k] and b[k] with no guess: whether they show one place by themselves, whether the match is good
/// enough to count where it says what others have said, and T_a_b.
py::tuple match_views(const Floats& a, const Floats& b) {
  if (a.ndim() != 2 || b.ndim() != 2 || a.shape(1) != kViewBeams || b.shape(1) != kViewBeams ||
      a.shape(0) != b.shape(0))
    throw std::invalid_argument("a, b: expected views of shape (n, 360)");
  const auto n = static_cast<std::size_t>(a.shape(0));
  std::vector<char> same(n, 0), usable(n, 0);
  std::vector<Pose2> poses(n);
  {
    const py::gil_scoped_release release;
    ScanMatcher matcher;
    for (std::size_t k = 0; k < n; ++k) {
      const MatchResult match = matcher.match(view_scan(a.data(static_cast<py::ssize_t>(k), 0)),
                                              view_scan(b.data(static_cast<py::ssize_t>(k), 0)));
      const bool sharp = match.usable && most_sigma(match.covariance) < kMostSigmaM;
      same[k] = sharp && is_same_place(match);
      usable[k] = sharp && match.diagnostics.violation <= kMostViolationAgreeing;
      poses[k] = match.T_ref_scan;
    }
  }
  const auto truth = [](char c) { return c != 0; };
  return py::make_tuple(value_array<bool>(same, truth), value_array<bool>(usable, truth),
                        pose_array(poses, [](const Pose2& p) { return p; }));
}

std::int32_t dot(const std::int8_t* a, const std::int8_t* b) {
  std::int32_t sum = 0;
  for (std::size_t i = 0; i < kDescriptorSize; ++i)
    sum += static_cast<std::int32_t>(a[i]) * static_cast<std::int32_t>(b[i]);
  return sum;
}

PlaceDescriptor descriptor_at(const std::int8_t* numbers, const std::uint8_t* turning) {
  PlaceDescriptor out;
  std::copy_n(numbers, kDescriptorSize, out.numbers.begin());
  std::copy_n(turning, kTurningSize, out.turning.begin());
  return out;
}

/// The places most like one query among the rows `members` of an index, as PlaceIndex::most_alike finds them:
/// `shortlist` by the numbers that do not turn, the `count` best of them over all turns and by their numbers; none that
/// is too far. @return their rows and likenesses, best first; lower rows first among equals
py::tuple alike_places(const Numbers& numbers, const Turning& turning, const Rows& members,
                       const Numbers& query_numbers, const Turning& query_turning, std::size_t count,
                       std::size_t shortlist) {
  if (query_numbers.size() != kDescriptorSize || query_turning.size() != kTurningSize)
    throw std::invalid_argument("query: expected one descriptor");
  std::vector<std::pair<std::int64_t, std::int64_t>> near;  // distance or likeness negated, row
  {
    const py::gil_scoped_release release;
    const std::int8_t* const query = query_numbers.data();
    const std::int32_t length = dot(query, query);
    near.reserve(static_cast<std::size_t>(members.size()));
    for (py::ssize_t k = 0; k < members.size(); ++k) {
      const std::int64_t row = members.data()[k];
      const std::int8_t* const place = numbers.data(row, 0);
      const std::int64_t distance = dot(place, place) - 2 * dot(place, query) + length;
      if (distance <= kMostDistance) near.emplace_back(distance, row);
    }
    const std::size_t kept = std::min(shortlist, near.size());
    std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(kept), near.end());
    near.resize(kept);
    const PlaceDescriptor wanted = descriptor_at(query, query_turning.data());
    for (auto& [likeness, row] : near)
      likeness = -turned_likeness(wanted, descriptor_at(numbers.data(row, 0), turning.data(row, 0))) -
                 kNumbersCount * dot(query, numbers.data(row, 0));
    std::sort(near.begin(), near.end());
    near.resize(std::min(count, near.size()));
  }
  return py::make_tuple(value_array<std::int64_t>(near, [](const auto& item) { return item.second; }),
                        value_array<std::int64_t>(near, [](const auto& item) { return -item.first; }));
}

}  // namespace

void bind_places(py::module_& module) {
  py::module_ places = module.def_submodule("_places", "What `phasescan.fleet` compares; not for users.");
  places.def("session_views", &session_views, py::arg("path"));
  places.def("match_views", &match_views, py::arg("a"), py::arg("b"));
  places.def("alike_places", &alike_places, py::arg("numbers"), py::arg("turning"), py::arg("members"),
             py::arg("query_numbers"), py::arg("query_turning"), py::arg("count"), py::arg("shortlist"));
}

}  // namespace phasescan::python
