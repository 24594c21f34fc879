#include "sim/passage.hpp"

#include <algorithm>
#include <cmath>

namespace phasescan::sim {
namespace {

/// Fine where it is narrow, coarse in halls.
double cell_size(const RoomPlan& room) {
  return room.area() > 80.0 ? 0.2 : 0.1;
}

constexpr double kHalfWay_m = 0.33;  ///< half of the narrowest way left open

}  // namespace

PassageGrid::PassageGrid(const RoomPlan& room, std::vector<Eigen::Vector2d> entrances)
    : x0_(room.x0),
      y0_(room.y0),
      cell_(cell_size(room)),
      columns_(static_cast<int>(room.width() / cell_) + 1),
      rows_(static_cast<int>(room.height() / cell_) + 1) {
  const auto cells = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  blocked_.assign(cells, 0);
  seen_.assign(cells, 0);
  for (int r = 0; r < rows_; ++r) {
    for (int c = 0; c < columns_; ++c) {
      const double x = (c + 0.5) * cell_, y = (r + 0.5) * cell_;
      const double wall = std::min({x, y, room.width() - x, room.height() - y});
      if (wall < kHalfWay_m) blocked_[static_cast<std::size_t>(r * columns_ + c)] = 1;
    }
  }
  for (const Eigen::Vector2d& p : entrances) {
    const int c = std::clamp(static_cast<int>((p.x() - x0_) / cell_), 0, columns_ - 1);
    const int r = std::clamp(static_cast<int>((p.y() - y0_) / cell_), 0, rows_ - 1);
    entrances_.push_back(r * columns_ + c);
    blocked_[static_cast<std::size_t>(entrances_.back())] = 0;
  }
}

bool PassageGrid::try_block(const Footprint& thing) {
  const double reach = 0.5 * std::hypot(thing.width, thing.depth) + kHalfWay_m;
  const Pose2 T_item_room = thing.T_room_item.inverse();
  const auto low = [&](double center, double origin) {
    return std::max(0, static_cast<int>((center - reach - origin) / cell_));
  };
  const auto high = [&](double center, double origin, int count) {
    return std::min(count - 1, static_cast<int>((center + reach - origin) / cell_));
  };
  std::vector<int> changed;
  for (int r = low(thing.T_room_item.y, y0_); r <= high(thing.T_room_item.y, y0_, rows_); ++r) {
    for (int c = low(thing.T_room_item.x, x0_); c <= high(thing.T_room_item.x, x0_, columns_); ++c) {
      const int i = r * columns_ + c;
      if (blocked_[static_cast<std::size_t>(i)]) continue;
      const Eigen::Vector2d p = T_item_room * Eigen::Vector2d(x0_ + (c + 0.5) * cell_, y0_ + (r + 0.5) * cell_);
      const double dx = std::max(0.0, std::abs(p.x()) - 0.5 * thing.width),
                   dy = std::max(0.0, std::abs(p.y()) - 0.5 * thing.depth);
      if (dx * dx + dy * dy >= kHalfWay_m * kHalfWay_m) continue;
      blocked_[static_cast<std::size_t>(i)] = 1;
      changed.push_back(i);
    }
  }
  if (changed.empty() || passable()) return true;
  for (const int i : changed) blocked_[static_cast<std::size_t>(i)] = 0;
  return false;
}

bool PassageGrid::passable() const {
  if (entrances_.empty()) return true;
  constexpr double kReachable_min = 0.7;
  for (const int e : entrances_) {
    if (blocked_[static_cast<std::size_t>(e)]) return false;
  }
  std::fill(seen_.begin(), seen_.end(), std::uint8_t{0});
  stack_.assign(1, entrances_[0]);
  seen_[static_cast<std::size_t>(entrances_[0])] = 1;
  std::size_t reached = 0;
  const auto visit = [&](int i) {
    if (blocked_[static_cast<std::size_t>(i)] || seen_[static_cast<std::size_t>(i)]) return;
    seen_[static_cast<std::size_t>(i)] = 1;
    stack_.push_back(i);
  };
  while (!stack_.empty()) {
    const int i = stack_.back(), c = i % columns_;
    stack_.pop_back();
    ++reached;
    if (c > 0) visit(i - 1);
    if (c + 1 < columns_) visit(i + 1);
    if (i >= columns_) visit(i - columns_);
    if (i + columns_ < columns_ * rows_) visit(i + columns_);
  }
  const auto free = static_cast<double>(std::count(blocked_.begin(), blocked_.end(), std::uint8_t{0}));
  return std::all_of(entrances_.begin(), entrances_.end(),
                     [&](int e) { return seen_[static_cast<std::size_t>(e)] != 0; }) &&
         static_cast<double>(reached) >= kReachable_min * free;
}

}  // namespace phasescan::sim
