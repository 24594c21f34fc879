#include "sim/free_space.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>

namespace phasescan::sim {
namespace {

using Eigen::Vector2d;

constexpr double kCell_m = 0.05;
constexpr float kFar = 1e12F;

/// Squared distance to the nearest zero of a row of squared distances: the lower envelope of parabolas
/// [Felzenszwalb12].
void transform_row(const std::vector<float>& in, std::vector<float>& out, std::vector<int>& vertex,
                   std::vector<float>& border) {
  const int n = static_cast<int>(in.size());
  int k = 0;
  vertex[0] = 0;
  border[0] = -kFar;
  border[1] = kFar;
  for (int q = 1; q < n; ++q) {
    const auto meet = [&](int v) {
      const auto fq = in[static_cast<std::size_t>(q)] + static_cast<float>(q) * static_cast<float>(q);
      const auto fv = in[static_cast<std::size_t>(v)] + static_cast<float>(v) * static_cast<float>(v);
      return (fq - fv) / (2.0F * static_cast<float>(q - v));
    };
    float s = meet(vertex[static_cast<std::size_t>(k)]);
    while (k > 0 && s <= border[static_cast<std::size_t>(k)]) s = meet(vertex[static_cast<std::size_t>(--k)]);
    if (s <= border[static_cast<std::size_t>(k)]) s = border[static_cast<std::size_t>(k)];
    vertex[static_cast<std::size_t>(++k)] = q;
    border[static_cast<std::size_t>(k)] = s;
    border[static_cast<std::size_t>(k) + 1] = kFar;
  }
  k = 0;
  for (int q = 0; q < n; ++q) {
    while (border[static_cast<std::size_t>(k) + 1] < static_cast<float>(q)) ++k;
    const auto d = static_cast<float>(q - vertex[static_cast<std::size_t>(k)]);
    out[static_cast<std::size_t>(q)] = d * d + in[static_cast<std::size_t>(vertex[static_cast<std::size_t>(k)])];
  }
}

}  // namespace

FreeSpace::FreeSpace(const World& world) {
  Vector2d low = Vector2d::Constant(1e300), high = Vector2d::Constant(-1e300);
  for (const Polygon& room : world.rooms) {
    for (const Vector2d& p : room) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  if (world.rooms.empty()) return;
  constexpr double kMargin_m = 0.5;
  origin_ = low.array() - kMargin_m;
  columns_ = static_cast<int>((high.x() - low.x() + 2.0 * kMargin_m) / kCell_m) + 1;
  rows_ = static_cast<int>((high.y() - low.y() + 2.0 * kMargin_m) / kCell_m) + 1;
  const auto w = static_cast<std::size_t>(columns_), h = static_cast<std::size_t>(rows_);
  clearance_.assign(w * h, kFar);

  const auto mark = [&](const Vector2d& p) {
    if (const int i = index(p); i >= 0) clearance_[static_cast<std::size_t>(i)] = 0.0F;
  };
  const auto mark_line = [&](const Vector2d& a, const Vector2d& b) {
    const int steps = static_cast<int>((b - a).norm() / (0.5 * kCell_m)) + 1;
    for (int i = 0; i <= steps; ++i) mark(a + (b - a) * (static_cast<double>(i) / steps));
  };
  for (const Segment& s : world.shape.segments) mark_line(s.a, s.b);
  for (const Disc& d : world.shape.discs) {
    const int steps = static_cast<int>(kTwoPi * d.radius / (0.5 * kCell_m)) + 4;
    for (int i = 0; i < steps; ++i) {
      const double angle = kTwoPi * i / steps;
      mark(d.center + d.radius * Vector2d(std::cos(angle), std::sin(angle)));
    }
  }
  // Where no room is, nobody goes: the outside of the building, and what is only looked into.
  for (int i = 0; i < columns_ * rows_; ++i) {
    const Vector2d p = center(i);
    const auto contains = [&](const Polygon& room) { return inside_polygon(room, p); };
    const auto near_door = [&](const Doorway& d) { return point_segment_distance(p, d.a, d.b) < 0.5; };
    if (std::none_of(world.rooms.begin(), world.rooms.end(), contains) &&
        std::none_of(world.doors.begin(), world.doors.end(), near_door)) {
      clearance_[static_cast<std::size_t>(i)] = 0.0F;
    }
  }

  const std::size_t longest = std::max(w, h);
  std::vector<int> vertex(longest + 1);
  std::vector<float> border(longest + 2);
  std::vector<float> in(h), out(h);
  for (std::size_t c = 0; c < w; ++c) {
    for (std::size_t r = 0; r < h; ++r) in[r] = clearance_[r * w + c];
    transform_row(in, out, vertex, border);
    for (std::size_t r = 0; r < h; ++r) clearance_[r * w + c] = out[r];
  }
  in.resize(w);
  out.resize(w);
  for (std::size_t r = 0; r < h; ++r) {
    std::copy_n(clearance_.begin() + static_cast<std::ptrdiff_t>(r * w), w, in.begin());
    transform_row(in, out, vertex, border);
    for (std::size_t c = 0; c < w; ++c) clearance_[r * w + c] = static_cast<float>(kCell_m) * std::sqrt(out[c]);
  }
}

int FreeSpace::index(const Vector2d& p) const {
  const double x = std::floor((p.x() - origin_.x()) / kCell_m), y = std::floor((p.y() - origin_.y()) / kCell_m);
  if (!(x >= 0.0 && y >= 0.0 && x < columns_ && y < rows_)) return -1;
  return static_cast<int>(y) * columns_ + static_cast<int>(x);
}

Vector2d FreeSpace::center(int i) const {
  return origin_ + kCell_m * Vector2d(i % columns_ + 0.5, i / columns_ + 0.5);
}

double FreeSpace::clearance(const Vector2d& p) const {
  const int i = index(p);
  return i >= 0 ? static_cast<double>(clearance_[static_cast<std::size_t>(i)]) : 0.0;
}

double FreeSpace::Distances::at(const Vector2d& p) const {
  const int i = space_->index(p);
  const float cost = i >= 0 ? cost_[static_cast<std::size_t>(i)] : std::numeric_limits<float>::infinity();
  return static_cast<double>(cost);
}

FreeSpace::Distances FreeSpace::distances_from(const Vector2d& start, double clearance_m) const {
  Distances out;
  out.space_ = this;
  out.cost_.assign(clearance_.size(), std::numeric_limits<float>::infinity());
  out.from_.assign(clearance_.size(), -1);
  const int first = index(start);
  if (first < 0) return out;
  const auto least = static_cast<float>(clearance_m);
  using Entry = std::pair<float, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  out.cost_[static_cast<std::size_t>(first)] = 0.0F;
  open.emplace(0.0F, first);
  while (!open.empty()) {
    const auto [cost, i] = open.top();
    open.pop();
    if (cost > out.cost_[static_cast<std::size_t>(i)]) continue;
    const int c = i % columns_, r = i / columns_;
    for (int dr = -1; dr <= 1; ++dr) {
      for (int dc = -1; dc <= 1; ++dc) {
        if ((dr == 0 && dc == 0) || c + dc < 0 || c + dc >= columns_ || r + dr < 0 || r + dr >= rows_) continue;
        const int j = (r + dr) * columns_ + c + dc;
        const float room = clearance_[static_cast<std::size_t>(j)];
        if (room < least) continue;
        // Up to three times dearer right at the limit, so that ways keep to the middle.
        constexpr float kRoomy_m = 0.4F;
        const float dear = 1.0F + 2.0F * std::max(0.0F, 1.0F - (room - least) / kRoomy_m);
        const float next = cost + dear * static_cast<float>(kCell_m) * (dr != 0 && dc != 0 ? 1.41421356F : 1.0F);
        if (next >= out.cost_[static_cast<std::size_t>(j)]) continue;
        out.cost_[static_cast<std::size_t>(j)] = next;
        out.from_[static_cast<std::size_t>(j)] = i;
        open.emplace(next, j);
      }
    }
  }
  return out;
}

bool FreeSpace::straight(const Vector2d& a, const Vector2d& b, double clearance_m) const {
  const int steps = static_cast<int>((b - a).norm() / (0.5 * kCell_m)) + 1;
  for (int i = 0; i <= steps; ++i) {
    if (clearance(a + (b - a) * (static_cast<double>(i) / steps)) < clearance_m) return false;
  }
  return true;
}

std::optional<std::vector<Vector2d>> FreeSpace::way(const Distances& from, const Vector2d& goal,
                                                    double clearance_m) const {
  int i = index(goal);
  if (i < 0 || !std::isfinite(from.cost_[static_cast<std::size_t>(i)])) return {};
  std::vector<Vector2d> cells;
  for (; i >= 0; i = from.from_[static_cast<std::size_t>(i)]) cells.push_back(center(i));
  std::reverse(cells.begin(), cells.end());
  // Pulled straight over at most 2 m, so that the preference for the middle survives.
  constexpr double kPull_m = 2.0;
  std::vector<Vector2d> legs{cells.front()};
  std::size_t at = 0;
  while (at + 1 < cells.size()) {
    std::size_t next = at + 1;
    for (std::size_t k = at + 2; k < cells.size() && (cells[k] - cells[at]).norm() < kPull_m; ++k) {
      if (straight(cells[at], cells[k],
                   std::min(clearance_m + kCell_m, std::min(clearance(cells[at]), clearance(cells[k])))))
        next = k;
    }
    legs.push_back(cells[next]);
    at = next;
  }
  return legs;
}

}  // namespace phasescan::sim
