#include "sim/furniture.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace phasescan::sim {
namespace {

using Eigen::Vector2d;

Material surface(Random& random, double black, double glass) {
  const double u = random.uniform();
  if (u < black) return Material::kBlack;
  return u < black + glass ? Material::kGlass : Material::kMatt;
}

Item box(double width, double depth, Material material) {
  Item item{{}, width, depth};
  item.shape.add_box({0.0, 0.0}, width, depth, material);
  return item;
}

void add_legs(Shape& shape, const Vector2d& center, double width, double depth, double thickness, bool round,
              double turn, Material material) {
  const Pose2 T_shape_legs{center.x(), center.y(), turn};
  for (const double sx : {-0.5, 0.5}) {
    for (const double sy : {-0.5, 0.5}) {
      const Vector2d at = T_shape_legs * Vector2d(sx * width, sy * depth);
      if (round) {
        shape.add_disc(at, 0.5 * thickness, material);
      } else {
        shape.add_box(at, thickness, thickness, material);
      }
    }
  }
}

/// Open shelves: the front steps in and out by what stands in them.
Item shelf(Random& random) {
  const double width = random.uniform(0.6, 2.0), depth = random.uniform(0.25, 0.45);
  Item item{{}, width, depth};
  Polygon outline{{-0.5 * width, -0.5 * depth}, {0.5 * width, -0.5 * depth}, {0.5 * width, 0.5 * depth}};
  double x = 0.5 * width - 0.02;
  while (x > -0.5 * width + 0.05) {
    const double step = std::min(random.uniform(0.05, 0.3), x + 0.5 * width - 0.02);
    const double back = 0.5 * depth - random.uniform(0.0, 0.8) * depth * (random.chance(0.7) ? 0.35 : 1.0);
    outline.push_back({x, back});
    outline.push_back({x - step, back});
    x -= step;
  }
  outline.push_back({-0.5 * width, 0.5 * depth});
  item.shape.add_solid(outline, surface(random, 0.14, 0.0));
  return item;
}

Item sofa(Random& random) {
  const double width = random.uniform(1.3, 2.4), depth = random.uniform(0.75, 1.0), arm = random.uniform(0.12, 0.25);
  const double seat = 0.5 * depth - random.uniform(0.02, 0.12);
  Item item{{}, width, depth};
  const double w = 0.5 * width, d = 0.5 * depth;
  item.shape.add_solid(
      {{-w, -d}, {w, -d}, {w, d}, {w - arm, d}, {w - arm, seat}, {-w + arm, seat}, {-w + arm, d}, {-w, d}},
      surface(random, 0.22, 0.0));
  return item;
}

Item table(Random& random) {
  const double width = random.uniform(0.7, 1.9), depth = random.uniform(0.6, 1.0);
  Item item{{}, width + 0.9, depth + 0.9};
  const bool round = random.chance(0.4);
  if (random.chance(0.15)) {
    item.shape.add_disc({0.0, 0.0}, random.uniform(0.05, 0.2));
  } else {
    add_legs(item.shape, {0.0, 0.0}, width - 0.1, depth - 0.1, random.uniform(0.04, 0.08), round, 0.0,
             surface(random, 0.18, 0.0));
  }
  const int chairs = static_cast<int>(random.below(5));
  for (int i = 0; i < chairs; ++i) {
    const double side = i % 2 ? 1.0 : -1.0, along = (i / 2 ? 0.25 : -0.25) * width;
    const Vector2d at(along, side * (0.5 * depth + random.uniform(0.0, 0.25)));
    add_legs(item.shape, at, 0.38, 0.38, random.uniform(0.025, 0.045), random.chance(0.5), random.normal(0.0, 0.25),
             surface(random, 0.27, 0.0));
  }
  return item;
}

Item desk(Random& random) {
  const double width = random.uniform(1.1, 1.8), depth = random.uniform(0.6, 0.8);
  Item item{{}, width, depth};
  const Material material = surface(random, 0.11, 0.0);
  if (random.chance(0.5)) {
    item.shape.add_box({-0.5 * width + 0.02, 0.0}, 0.04, depth, material);
    item.shape.add_box({0.5 * width - 0.02, 0.0}, 0.04, depth, material);
  } else {
    add_legs(item.shape, {0.0, 0.0}, width - 0.08, depth - 0.08, 0.05, random.chance(0.3), 0.0, material);
  }
  if (random.chance(0.6)) {
    const double side = random.chance(0.5) ? 1.0 : -1.0;
    item.shape.add_box({side * (0.5 * width - 0.28), 0.0}, 0.42, 0.9 * depth, material);
  }
  if (random.chance(0.4)) item.shape.add_box({random.uniform(-0.2, 0.2), 0.0}, 0.18, 0.42, Material::kBlack);
  return item;
}

Item office_chair(Random& random) {
  Item item{{}, 0.65, 0.65};
  const Material material = surface(random, 0.50, 0.0);
  item.shape.add_disc({0.0, 0.0}, 0.035, material);
  const double turn = random.uniform(0.0, kTwoPi);
  for (int i = 0; i < 5; ++i) {
    const double angle = turn + i * kTwoPi / 5.0;
    item.shape.add_disc({0.28 * std::cos(angle), 0.28 * std::sin(angle)}, 0.028, material);
  }
  return item;
}

/// Bags, boxes, toys: an irregular convex-like blob.
Item clutter(Random& random) {
  const double radius = random.uniform(0.05, 0.28), stretch = random.uniform(0.6, 1.0);
  const auto corners = 4 + random.below(4);
  Polygon outline;
  const double turn = random.uniform(0.0, kTwoPi);
  for (std::uint64_t i = 0; i < corners; ++i) {
    const double angle =
        turn + kTwoPi * (static_cast<double>(i) + random.uniform(-0.25, 0.25)) / static_cast<double>(corners);
    const double r = radius * random.uniform(0.75, 1.0);
    outline.push_back({r * std::cos(angle), stretch * r * std::sin(angle)});
  }
  Item item{{}, 2.0 * radius, 2.0 * radius};
  item.shape.add_solid(outline, surface(random, 0.22, 0.0));
  return item;
}

Item radiator(Random& random) {
  const double width = random.uniform(0.6, 1.8), depth = random.uniform(0.08, 0.14);
  Item item{{}, width, depth};
  const int ribs = static_cast<int>(width / random.uniform(0.06, 0.12));
  Polygon outline{{-0.5 * width, -0.5 * depth}, {0.5 * width, -0.5 * depth}};
  const double step = width / (2 * ribs);
  for (int i = 0; i < 2 * ribs; ++i) {
    const double y = i % 2 ? 0.5 * depth - 0.03 : 0.5 * depth, x = 0.5 * width - i * step;
    outline.push_back({x, y});
    outline.push_back({x - step, y});
  }
  item.shape.add_solid(outline);
  return item;
}

Item curtain(Random& random) {
  const double width = random.uniform(0.4, 1.4), wave = random.uniform(0.08, 0.2), height = random.uniform(0.02, 0.06);
  Item item{{}, width, 0.15};
  Polygon line;
  for (double x = -0.5 * width; x <= 0.5 * width; x += 0.25 * wave)
    line.push_back({x, height * std::sin(kTwoPi * x / wave)});
  item.shape.add_line(line, surface(random, 0.18, 0.0));
  return item;
}

/// Storage racks of a hall: uprights with goods between them.
Item rack(Random& random) {
  const double bay = random.uniform(1.8, 2.8), depth = random.uniform(0.8, 1.2);
  const int bays = 1 + static_cast<int>(random.below(4));
  Item item{{}, bay * bays, depth};
  for (int i = 0; i <= bays; ++i) {
    for (const double side : {-0.5, 0.5}) item.shape.add_box({bay * (i - 0.5 * bays), side * (depth - 0.1)}, 0.1, 0.1);
    if (i == bays || random.chance(0.25)) continue;
    item.shape.add_box({bay * (i + 0.5 - 0.5 * bays) + random.uniform(-0.15, 0.15), random.uniform(-0.1, 0.1)},
                       random.uniform(0.4, 0.8) * bay, random.uniform(0.6, 0.9) * depth, surface(random, 0.14, 0.0));
  }
  return item;
}

}  // namespace

Item make_item(ItemKind kind, Random& random) {
  switch (kind) {
    case ItemKind::kCupboard:
      return box(random.uniform(0.4, 1.8), random.uniform(0.35, 0.65), surface(random, 0.09, 0.03));
    case ItemKind::kShelf:
      return shelf(random);
    case ItemKind::kBed:
      return box(random.uniform(0.85, 1.8), random.uniform(1.9, 2.1), surface(random, 0.11, 0.0));
    case ItemKind::kSofa:
      return sofa(random);
    case ItemKind::kTable:
      return table(random);
    case ItemKind::kDesk:
      return desk(random);
    case ItemKind::kOfficeChair:
      return office_chair(random);
    case ItemKind::kBin: {
      const double radius = random.uniform(0.1, 0.2);
      Item item{{}, 2.0 * radius, 2.0 * radius};
      item.shape.add_disc({0.0, 0.0}, radius, surface(random, 0.27, 0.0));
      return item;
    }
    case ItemKind::kClutter:
      return clutter(random);
    case ItemKind::kPlant: {
      const double radius = random.uniform(0.12, 0.28);
      Item item{{}, 2.0 * radius, 2.0 * radius};
      item.shape.add_disc({0.0, 0.0}, radius);
      return item;
    }
    case ItemKind::kRadiator:
      return radiator(random);
    case ItemKind::kCurtain:
      return curtain(random);
    case ItemKind::kBath:
      return box(random.uniform(0.4, 1.7), random.uniform(0.5, 0.75), Material::kMatt);
    case ItemKind::kPartition:
      return box(random.uniform(1.2, 3.2), 0.05, surface(random, 0.09, 0.08));
    case ItemKind::kMachine:
      return box(random.uniform(0.8, 4.0), random.uniform(0.8, 2.5), surface(random, 0.14, 0.0));
    case ItemKind::kPallet:
      return box(random.uniform(0.8, 1.2), random.uniform(0.8, 1.2), surface(random, 0.09, 0.0));
    case ItemKind::kRack:
      return rack(random);
  }
  return {};
}

Shape make_person(Random& random) {
  Shape shape;
  if (random.chance(0.25)) {
    shape.add_disc({0.0, 0.0}, random.uniform(0.14, 0.22), surface(random, 0.27, 0.0));
    return shape;
  }
  const double half = 0.5 * random.uniform(0.18, 0.4), turn = random.uniform(0.0, kPi),
               radius = random.uniform(0.05, 0.085);
  const Material material = surface(random, 0.36, 0.0);
  const Vector2d step(half * std::cos(turn), half * std::sin(turn));
  shape.add_disc(step, radius, material);
  shape.add_disc(-step, radius, material);
  return shape;
}

bool footprints_overlap(const Footprint& a, const Footprint& b, double margin) {
  const Vector2d half_a(0.5 * a.width + margin, 0.5 * a.depth + margin), half_b(0.5 * b.width, 0.5 * b.depth);
  const Eigen::Matrix2d axes_a = a.T_room_item.rotation(), axes_b = b.T_room_item.rotation();
  const Vector2d between = b.T_room_item.translation() - a.T_room_item.translation();
  for (const Vector2d& axis : std::array<Vector2d, 4>{axes_a.col(0), axes_a.col(1), axes_b.col(0), axes_b.col(1)}) {
    const double reach_a =
        half_a.x() * std::abs(axes_a.col(0).dot(axis)) + half_a.y() * std::abs(axes_a.col(1).dot(axis));
    const double reach_b =
        half_b.x() * std::abs(axes_b.col(0).dot(axis)) + half_b.y() * std::abs(axes_b.col(1).dot(axis));
    if (std::abs(between.dot(axis)) > reach_a + reach_b) return false;
  }
  return true;
}

}  // namespace phasescan::sim
