#include "phasescan/sim/pairs_spec.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "phasescan/io/error.hpp"
#include "sim/embedded.hpp"

namespace phasescan::sim {
namespace {

/// A YAML map whose keys are taken one by one; what is left over is a mistake.
class Fields {
 public:
  Fields(const YAML::Node& node, const std::string& file) : node_(node), file_(file) {
    if (!node.IsMap()) fail(node, "expected a map of names and values");
  }

  template <class T>
  void take(const char* key, T& value) {
    known_.insert(key);
    const YAML::Node field = node_[key];
    if (field) value = convert<T>(field, key);
  }

  /// A list, or a single value in place of one.
  template <class T>
  void take_list(const char* key, std::vector<T>& values) {
    known_.insert(key);
    const YAML::Node field = node_[key];
    if (!field) return;
    values.clear();
    if (field.IsSequence()) {
      for (const YAML::Node& item : field) values.push_back(convert<T>(item, key));
    } else {
      values.push_back(convert<T>(field, key));
    }
  }

  void finish() const {
    for (const auto& field : node_) {
      const auto key = field.first.as<std::string>("");
      if (!known_.contains(key)) fail(field.first, "unknown key '" + key + "'");
    }
  }

  [[noreturn]] void fail(const YAML::Node& at, const std::string& what) const { throw InputError(file_, at.Mark().line + 1, what); }

 private:
  template <class T>
  T convert(const YAML::Node& field, const char* key) const {
    try {
      if constexpr (std::is_enum_v<T>) {
        return enum_from_string<T>(field.as<std::string>());
      } else {
        return field.as<T>();
      }
    } catch (const YAML::Exception&) {
      fail(field, std::string(key) + ": expected " + (std::is_same_v<T, bool> ? "true or false" : std::is_arithmetic_v<T> ? "a number" : "a name"));
    } catch (const std::invalid_argument& error) {
      fail(field, std::string(key) + ": " + error.what());
    }
  }

  YAML::Node node_;
  std::string file_;
  std::set<std::string, std::less<>> known_;
};

YAML::Node load(const std::string& text, const std::string& name) {
  try {
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    throw InputError(name, error.mark.line + 1, "not YAML: " + error.msg);
  }
}

/// The file's text, or the built-in one's; `name` becomes what errors call it.
std::string find_text(const std::string& path_or_name, const std::string& folder, std::string& name) {
  if (std::filesystem::exists(path_or_name)) {
    name = path_or_name;
    if (std::filesystem::is_directory(path_or_name)) throw InputError(name, 0, "is a folder, expected a YAML file");
    std::ifstream in(path_or_name, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    if (!in) throw SystemError(name, "cannot be read");
    return text.str();
  }
  const std::string stem = std::filesystem::path(path_or_name).stem().string();
  std::string choices;
  for (const EmbeddedFile& file : embedded_files()) {
    const std::filesystem::path path{std::string(file.name)};
    if (path.parent_path() != folder) continue;
    if (path.stem() == stem) {
      name = path.filename().string();
      return std::string(file.text);
    }
    choices += (choices.empty() ? "" : ", ") + path.stem().string();
  }
  throw InputError(path_or_name, 0, "no such file, and not one of " + choices);
}

PairRow read_row(const YAML::Node& node, const std::string& file) {
  PairRow row;
  Fields fields(node, file);
  fields.take("dataset", row.dataset);
  fields.take_list("worlds", row.worlds);
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
  const YAML::Node node = load(text, name);
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
  const std::string text = find_text(path_or_name, "", name);
  return parse_pairs_spec(text, name);
}

LidarOptions parse_lidar(const std::string& text, const std::string& name) {
  const YAML::Node node = load(text, name);
  LidarOptions lidar;
  Fields fields(node, name);
  LidarOptions::visit(lidar, [&](std::string_view key, auto& value, const OptionInfo&) { fields.take(std::string(key).c_str(), value); });
  fields.finish();
  try {
    validate_options("sensor", lidar);
  } catch (const std::invalid_argument& error) {
    throw InputError(name, 0, error.what());
  }
  if (lidar.range_max_m <= lidar.range_min_m) throw InputError(name, 0, "range_max_m: must be above range_min_m");
  return lidar;
}

LidarOptions read_lidar(const std::string& path_or_name) {
  std::string name;
  const std::string text = find_text(path_or_name, "sensors", name);
  return parse_lidar(text, name);
}

std::vector<std::string> pairs_spec_names() {
  std::vector<std::string> names;
  for (const EmbeddedFile& file : embedded_files()) {
    const std::filesystem::path path{std::string(file.name)};
    if (path.parent_path().empty()) names.push_back(path.stem().string());
  }
  return names;
}

std::vector<std::string> lidar_names() {
  std::vector<std::string> names;
  for (const EmbeddedFile& file : embedded_files()) {
    const std::filesystem::path path{std::string(file.name)};
    if (path.parent_path() == "sensors") names.push_back(path.stem().string());
  }
  return names;
}

}  // namespace phasescan::sim
