#include "localize/view_table.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "localize/view_kernel.hpp"

namespace phasescan {
namespace {

constexpr float kSteps = 64.0F;        // of a byte per factor e in 1 m + range
constexpr double kClearM = 0.12;       // that a place of the lattice is from surfaces, where its cell has such a spot
constexpr double kSpreadBins = 0.75;   // a beam speaks for the directions within this many bins, or half a beam spacing
constexpr double kEmptyRunRad = 0.14;  // runs of missing beams at least so wide are emptiness, narrower ones lost beams
constexpr std::size_t kTurns = kViewDirections;
constexpr std::size_t kNeighbours = 2;      // coarse turns this near each other are one
constexpr std::size_t kCoarsePerMatch = 4;  // matches by the coarse directions that all directions choose from

/// The middle of a lattice cell, or the spot near it that is free and clear of surfaces; false where there is none.
bool clear_spot(const MapGrid& grid, double x0, double y0, double spacing, float& x, float& y) {
  static constexpr double kTried[][2] = {{0.5, 0.5}, {0.25, 0.25}, {0.75, 0.75}, {0.25, 0.75}, {0.75, 0.25}};
  const float needed = static_cast<float>(kClearM);
  for (const auto& at : kTried) {
    const auto px = static_cast<float>(x0 + at[0] * spacing), py = static_cast<float>(y0 + at[1] * spacing);
    const int i = static_cast<int>(px * grid.inverse_cell), k = static_cast<int>(py * grid.inverse_cell);
    if (!grid.is_free(i, k) || grid.distance_at(px, py) < needed) continue;
    x = px, y = py;
    return true;
  }
  return false;
}

struct Directions {
  std::array<float, kViewDirections> x, y;
  Directions() : x(), y() {
    for (std::size_t d = 0; d < kViewDirections; ++d) {
      const double angle = kTwoPi * static_cast<double>(d) / static_cast<double>(kViewDirections);
      x[d] = static_cast<float>(std::cos(angle)), y[d] = static_cast<float>(std::sin(angle));
    }
  }
};

/// The scan's view turned to every heading.
void fill_turns(const ScanView& scan, ViewSearch& search) {
  constexpr std::size_t kEveryDirection = kViewDirections / kCoarseDirections, kEveryTurn = kTurns / kCoarseTurns;
  search.rotated.resize(kTurns * kViewDirections);
  search.most.resize(kTurns * kViewDirections);
  search.coarse_rotated.resize(kCoarseDirections * kCoarseTurns);
  search.coarse_most.resize(kCoarseDirections * kCoarseTurns);
  for (std::size_t t = 0; t < kTurns; ++t) {
    for (std::size_t d = 0; d < kViewDirections; ++d) {
      const std::size_t from = (d + kViewDirections - t) % kViewDirections, to = t * kViewDirections + view_place(d);
      search.rotated[to] = scan.range[from];
      search.most[to] = scan.known[from] ? kMostDifference : std::uint8_t{0};
    }
  }
  for (std::size_t c = 0; c < kCoarseDirections; ++c) {
    for (std::size_t t = 0; t < kCoarseTurns; ++t) {
      const std::size_t from = t * kEveryTurn * kViewDirections + view_place(c * kEveryDirection);
      search.coarse_rotated[c * kCoarseTurns + t] = search.rotated[from];
      search.coarse_most[c * kCoarseTurns + t] = search.most[from];
    }
  }
}

bool better(const ViewMatch& a, const ViewMatch& b) {
  if (a.cost != b.cost) return a.cost < b.cost;
  return a.view != b.view ? a.view < b.view : a.turn < b.turn;
}

/// The turn of least cost and the best one that is no neighbour of it, where they are below the limit.
void add_two_best(const std::uint16_t* cost, std::uint32_t view, std::uint16_t limit, std::vector<ViewMatch>& out) {
  std::size_t first = 0;
  for (std::size_t t = 1; t < kCoarseTurns; ++t) {
    if (cost[t] < cost[first]) first = t;
  }
  out.push_back({view, static_cast<std::uint16_t>(first), cost[first]});
  std::size_t second = kCoarseTurns;
  for (std::size_t t = 0; t < kCoarseTurns; ++t) {
    const std::size_t apart = (t + kCoarseTurns - first) % kCoarseTurns;
    if (apart < kNeighbours || apart > kCoarseTurns - kNeighbours) continue;
    if (second == kCoarseTurns || cost[t] < cost[second]) second = t;
  }
  if (cost[second] < limit) out.push_back({view, static_cast<std::uint16_t>(second), cost[second]});
}

/// The best fine turn beside a coarse one, by all directions.
void refine_match(const ViewTable& views, std::uint8_t reach, const ViewSearch& search, ViewMatch& match) {
  const std::size_t coarse = match.turn * (kTurns / kCoarseTurns);
  match.cost = std::numeric_limits<std::uint16_t>::max();
  for (const std::size_t t : {coarse, (coarse + 1) % kTurns, (coarse + kTurns - 1) % kTurns}) {
    const std::size_t row = t * kViewDirections;
    const std::uint16_t cost =
        compare_at_turn(views.view(match.view), reach, search.rotated.data() + row, search.most.data() + row);
    if (cost < match.cost) match.cost = cost, match.turn = static_cast<std::uint16_t>(t);
  }
}

void keep_best(std::vector<ViewMatch>& matches, std::size_t most) {
  if (matches.size() <= most) return;
  std::nth_element(matches.begin(), matches.begin() + static_cast<std::ptrdiff_t>(most), matches.end(), better);
  matches.resize(most);
}

}  // namespace

std::uint8_t view_byte(float range_m) {
  return static_cast<std::uint8_t>(std::min(255.0F, std::round(kSteps * std::log1p(std::max(0.0F, range_m)))));
}

ViewTable make_views(const MapGrid& grid, double spacing_m, double range_m) {
  ViewTable views;
  const double width = grid.width * static_cast<double>(grid.cell_m),
               height = grid.height * static_cast<double>(grid.cell_m);
  for (double y = 0.0; y < height; y += spacing_m) {
    for (double x = 0.0; x < width; x += spacing_m) {
      float px = 0, py = 0;
      if (!clear_spot(grid, x, y, spacing_m, px, py)) continue;
      views.x.push_back(px);
      views.y.push_back(py);
    }
  }
  const Directions directions;
  const auto most = static_cast<float>(range_m);
  views.bytes.resize(views.size() * kViewDirections);
  for (std::size_t i = 0; i < views.size(); ++i) {
    std::uint8_t* const view = views.bytes.data() + i * kViewDirections;
    for (std::size_t d = 0; d < kViewDirections; ++d)
      view[view_place(d)] = view_byte(grid.cast(views.x[i], views.y[i], directions.x[d], directions.y[d], most));
  }
  return views;
}

ScanView view_of(const Scan& scan) {
  ScanView view;
  constexpr double kBin = kTwoPi / static_cast<double>(kViewDirections);
  struct Bin {
    double nearest = 1e9;
    float nearest_range = 0.0F;
    bool looked = false;
  };
  std::array<Bin, kViewDirections> bins;
  const std::size_t n = scan.size();
  const double step = n > 1 ? std::abs(scan.angle(1) - scan.angle(0)) : 0.0;
  const double reach = scan.geometry.range_max > 0.0 ? scan.geometry.range_max : 0.0;
  if (reach > 0.0) view.reach = view_byte(static_cast<float>(reach));
  const double spread = std::max(kSpreadBins * kBin, std::min(0.5 * step, 2.0 * kBin));
  std::size_t run = 0;
  for (std::size_t i = 0; i <= n; ++i) {
    const bool missing = i < n && !scan.is_hit(i);
    if (missing) {
      ++run;
      continue;
    }
    const bool empty = static_cast<double>(run) * step >= kEmptyRunRad;
    for (std::size_t b = i - run; empty && b < i; ++b) {
      const BeamState state = scan.states[b];
      if (state != BeamState::kOutOfRange && state != BeamState::kNoReturn) continue;
      const auto bin = static_cast<std::size_t>(std::lround(wrap_positive(scan.angle(b)) / kBin)) % kViewDirections;
      bins[bin].looked = true;
    }
    run = 0;
    if (i == n) break;
    const double at = wrap_positive(scan.angle(i)) / kBin;
    const int from = static_cast<int>(std::ceil(at - spread / kBin)),
              to = static_cast<int>(std::floor(at + spread / kBin));
    for (int k = from; k <= to; ++k) {
      Bin& bin = bins[static_cast<std::size_t>((k + 2 * static_cast<int>(kViewDirections)) %
                                               static_cast<int>(kViewDirections))];
      const double off = std::abs(at - k);
      if (off < bin.nearest) bin.nearest = off, bin.nearest_range = scan.ranges[i];
    }
  }
  for (std::size_t d = 0; d < kViewDirections; ++d) {
    if (bins[d].nearest < 1e8) {
      view.range[d] = view_byte(bins[d].nearest_range);
    } else if (bins[d].looked && reach > 0.0) {
      view.range[d] = view.reach;
    } else {
      continue;
    }
    view.known[d] = 255;
    ++view.known_count;
  }
  return view;
}

void match_views(const ViewTable& views, const ScanView& scan, std::size_t most, ViewSearch& search) {
  fill_turns(scan, search);
  search.best.clear();
  const std::size_t coarse = kCoarsePerMatch * most;
  std::uint16_t limit = std::numeric_limits<std::uint16_t>::max();
  alignas(64) std::uint16_t cost[kCoarseTurns];
  for (std::size_t i = 0; i < views.size(); ++i) {
    const std::uint16_t least = compare_at_coarse_turns(views.view(i), scan.reach, search.coarse_rotated.data(),
                                                        search.coarse_most.data(), cost);
    if (least >= limit) continue;
    add_two_best(cost, static_cast<std::uint32_t>(i), limit, search.best);
    if (search.best.size() < 2 * coarse) continue;
    keep_best(search.best, coarse);
    limit = std::max_element(search.best.begin(), search.best.end(), better)->cost;
  }
  keep_best(search.best, coarse);
  for (ViewMatch& match : search.best) refine_match(views, scan.reach, search, match);
  keep_best(search.best, most);
  std::sort(search.best.begin(), search.best.end(), better);
}

}  // namespace phasescan
