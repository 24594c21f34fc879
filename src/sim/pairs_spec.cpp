#include "sim/pairs_spec.hpp"

#include "sim/world_file.hpp"
#include "sim/yaml_fields.hpp"

namespace phasescan::sim {
namespace {

PairRow read_row(const YAML::Node& node, const std::string& file) {
  PairRow row;
  Fields fields(node, file);
  fields.take("dataset", row.dataset);
  fields.take_list("worlds", row.worlds);
  std::string world_file;
  fields.take("world_file", world_file);
  if (!world_file.empty()) row.fixed = std::make_shared<const World>(read_world(world_file));
  fields.take_list("classes", row.classes);
  fields.take("sensor", row.sensor);
  fields.take("weight", row.weight);
  fields.take("fov_deg", row.fov_deg);
  fields.take("clearance_m", row.clearance_m);
  fields.take("overlap_min", row.overlap_min);
  fields.take("overlap_max", row.overlap_max);
  fields.take("turned_frame", row.turned_frame);
  fields.take("through_door", row.through_door);
  fields.take("moved_min", row.moved_min);
  fields.take("moved_max", row.moved_max);
  fields.take("people_max", row.people_max);
  fields.take("dead_min_deg", row.dead_min_deg);
  fields.take("dead_max_deg", row.dead_max_deg);
  fields.take("moved_share", row.moved_share);
  fields.finish();
  try {
    check_pair_row(row);
  } catch (const std::invalid_argument& error) {
    fields.fail(node, error.what());
  }
  return row;
}

}  // namespace

PairsSpec parse_pairs_spec(const std::string& text, const std::string& name) {
  const YAML::Node node = load_yaml(text, name);
  PairsSpec spec;
  Fields fields(node, name);
  fields.take("seed", spec.seed);
  std::vector<YAML::Node> rows;
  fields.take_list("rows", rows);
  fields.finish();
  for (const YAML::Node& row : rows) spec.rows.push_back(read_row(row, name));
  if (spec.rows.empty()) throw InputError(name, 0, "rows: none given");
  return spec;
}

PairsSpec read_pairs_spec(const std::string& path_or_name) {
  std::string name;
  const std::string text = find_config(path_or_name, "", name);
  return parse_pairs_spec(text, name);
}

namespace {

LidarOptions parse_lidar_from(const std::string& text, const std::string& name, int depth) {
  constexpr int kDepth = 8;
  const YAML::Node node = load_yaml(text, name);
  LidarOptions lidar;
  Fields fields(node, name);
  std::string like;
  fields.take("like", like);
  if (!like.empty()) {
    if (depth >= kDepth) fields.fail_at("like", "like: files that name each other, or more than 8 of them");
    std::string base_name;
    const std::string base = find_config(like, "sensors", base_name);
    lidar = parse_lidar_from(base, base_name, depth + 1);
  }
  LidarOptions::visit(lidar, [&](std::string_view key, auto& value, const OptionInfo& info) {
    fields.take_option(std::string(key).c_str(), value, info);
  });
  fields.finish();
  const auto below = [&](const char* upper, double high, const char* lower, double low, bool equal) {
    if (high < low || (high == low && !equal))
      fields.fail_at(node[upper] ? upper : lower,
                     std::string(upper) + ": must " + (equal ? "not be below " : "be above ") + lower);
  };
  const SensorEffects& e = lidar.effects;
  below("range_max_m", lidar.range_max_m, "range_min_m", lidar.range_min_m, false);
  below("lost_burst_max", e.lost_burst_max, "lost_burst_min", e.lost_burst_min, true);
  below("lost_sector_max_deg", e.lost_sector_max_deg, "lost_sector_min_deg", e.lost_sector_min_deg, true);
  below("wrong_start_max_deg", e.wrong_start_max_deg, "wrong_start_min_deg", e.wrong_start_min_deg, true);
  try {
    check_lidar("sensor", lidar);
  } catch (const std::invalid_argument& error) {
    fields.fail(node, error.what());
  }
  return lidar;
}

}  // namespace

LidarOptions parse_lidar(const std::string& text, const std::string& name) {
  return parse_lidar_from(text, name, 0);
}

LidarOptions read_lidar(const std::string& path_or_name) {
  std::string name;
  const std::string text = find_config(path_or_name, "sensors", name);
  return parse_lidar(text, name);
}

std::vector<std::string> pairs_spec_names() {
  return config_names("");
}
std::vector<std::string> lidar_names() {
  return config_names("sensors");
}

}  // namespace phasescan::sim
