#include "sim/world_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

#include "io/file.hpp"
#include "io/nearest_word.hpp"
#include "sim/yaml_fields.hpp"

namespace phasescan {

template <>
std::span<const std::string_view> enum_names<sim::Material>() {
  static constexpr std::string_view names[] = {"matt", "black", "glass"};
  return names;
}

}  // namespace phasescan

namespace phasescan::sim {
namespace {

using Eigen::Vector2d;

Vector2d point_from(const YAML::Node& node, const std::string& file) {
  const auto number = [&](std::size_t i) {
    const double value = node[i].as<double>(std::nan(""));
    constexpr double kFarthest_m = 1e5;
    if (!(std::abs(value) <= kFarthest_m))
      throw InputError(file, node.Mark().line + 1, "expected a point [x, y] in metres");
    return value;
  };
  if (!node.IsSequence() || node.size() != 2) throw InputError(file, node.Mark().line + 1, "expected a point [x, y]");
  return {number(0), number(1)};
}

Polygon points_from(const YAML::Node& node, const std::string& file, std::size_t least) {
  if (!node.IsSequence() || node.size() < least) {
    throw InputError(file, node.Mark().line + 1, "expected " + std::to_string(least) + " or more points [[x, y], ...]");
  }
  Polygon points;
  for (const YAML::Node& item : node) points.push_back(point_from(item, file));
  return points;
}

void add_wall(const YAML::Node& node, const std::string& file, Shape& shape) {
  Fields fields(node, file);
  YAML::Node points;
  bool closed = false;
  Material material = Material::kMatt;
  fields.take("points", points);
  fields.take("closed", closed);
  fields.take("material", material);
  fields.finish();
  if (!points.IsDefined() || points.IsNull()) fields.fail(node, "points: missing");
  const Polygon line = points_from(points, file, closed ? 3 : 2);
  if (closed)
    shape.add_solid(line, material);
  else
    shape.add_line(line, material);
}

void add_disc(const YAML::Node& node, const std::string& file, Shape& shape) {
  Fields fields(node, file);
  YAML::Node center;
  double radius = 0.0;
  Material material = Material::kMatt;
  fields.take("center", center);
  fields.take("radius", radius);
  fields.take("material", material);
  fields.finish();
  if (!center.IsDefined() || center.IsNull()) fields.fail(node, "center: missing");
  if (!(radius > 0.0 && radius < 1e4)) fields.fail(node, "radius: must be above 0");
  shape.add_disc(point_from(center, file), radius, material);
}

}  // namespace

World parse_world(const std::string& text, const std::string& name) {
  const YAML::Node node = load_yaml(text, name);
  World world;
  world.name = std::filesystem::path(name).stem().string();
  Fields fields(node, name);
  std::vector<YAML::Node> walls, discs, rooms, doors;
  fields.take("name", world.name);
  fields.take_list("walls", walls);
  fields.take_list("discs", discs);
  fields.take_list("rooms", rooms);
  fields.take_list("doors", doors);
  fields.finish();
  for (const YAML::Node& wall : walls) add_wall(wall, name, world.shape);
  for (const YAML::Node& disc : discs) add_disc(disc, name, world.shape);
  for (const YAML::Node& room : rooms) world.rooms.push_back(points_from(room, name, 3));
  for (const YAML::Node& door : doors) {
    const Polygon ends = points_from(door, name, 2);
    world.doors.push_back({ends[0], ends[1]});
  }
  if (world.shape.segments.empty()) throw InputError(name, 0, "walls: none given");
  if (world.rooms.empty()) {
    Vector2d low = world.shape.segments[0].a, high = low;
    for (const Segment& s : world.shape.segments) {
      low = low.cwiseMin(s.a).cwiseMin(s.b);
      high = high.cwiseMax(s.a).cwiseMax(s.b);
    }
    world.rooms.push_back({low, {high.x(), low.y()}, high, {low.x(), high.y()}});
  }
  return world;
}

World read_world(const std::string& path) {
  return parse_world(read_file(path), path);
}

std::optional<WorldKind> world_kind(std::string_view name) {
  if (name == "apartment") return WorldKind::kFlat;
  const auto names = enum_names<WorldKind>();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return {};
  return static_cast<WorldKind>(found - names.begin());
}

World world_by_name(const std::string& kind_or_file, std::uint64_t seed) {
  const std::size_t colon = kind_or_file.find(':');
  const auto kind = world_kind(std::string_view(kind_or_file).substr(0, colon));
  if (!kind) {
    if (std::filesystem::exists(kind_or_file)) return read_world(kind_or_file);
    std::string choices;
    for (const std::string_view name : enum_names<WorldKind>())
      choices += (choices.empty() ? "" : ", ") + std::string(name);
    const std::string_view word = std::string_view(kind_or_file).substr(0, colon);
    throw InputError(kind_or_file, 0,
                     "no such file, and not one of " + choices + did_you_mean(word, enum_names<WorldKind>()));
  }
  if (colon != std::string::npos) {
    const char* end = kind_or_file.data() + kind_or_file.size();
    const auto [stop, error] = std::from_chars(kind_or_file.data() + colon + 1, end, seed);
    if (error != std::errc() || stop != end)
      throw InputError(kind_or_file, 0, "expected a number after the ':' of a kind of world");
  }
  return make_world(*kind, seed);
}

std::vector<Vector2d> read_points(const std::string& path) {
  const YAML::Node node = load_yaml(read_file(path), path);
  Fields fields(node, path);
  YAML::Node points;
  fields.take("points", points);
  fields.finish();
  if (!points.IsDefined() || points.IsNull()) throw InputError(path, 0, "points: missing");
  return points_from(points, path, 2);
}

}  // namespace phasescan::sim
