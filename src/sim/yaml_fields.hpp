/// Reading YAML with mistakes told by line; files of configs/ found in the program where no such file is there.
#pragma once

#include <yaml-cpp/yaml.h>

#include <set>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "phasescan/core/options.hpp"
#include "phasescan/io/error.hpp"
#include "io/yaml.hpp"

namespace phasescan::sim {

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

  /// The same for an option: a number outside its bounds is a mistake of its line.
  template <class T>
  void take_option(const char* key, T& value, const OptionInfo& info) {
    take(key, value);
    if constexpr (std::is_arithmetic_v<T> && !std::is_same_v<T, bool>) {
      const std::string complaint = option_complaint(static_cast<double>(value), info);
      if (!complaint.empty()) fail_at(key, std::string(key) + ": " + complaint);
    }
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

  /// At a key's value; at the map where the key is not given.
  [[noreturn]] void fail_at(const char* key, const std::string& what) const {
    const YAML::Node field = node_[key];
    fail(field ? field : node_, what);
  }

  [[noreturn]] void fail(const YAML::Node& at, const std::string& what) const {
    throw InputError(file_, at.Mark().line + 1, what);
  }

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
      fail(field, std::string(key) + ": expected " +
                      (std::is_same_v<T, bool>                                 ? "true or false"
                       : std::is_arithmetic_v<T>                               ? "a number"
                       : std::is_class_v<T> && !std::is_same_v<T, std::string> ? "a list of numbers"
                                                                               : "a name"));
    } catch (const std::invalid_argument& error) {
      fail(field, std::string(key) + ": " + error.what());
    }
  }

  YAML::Node node_;
  std::string file_;
  std::set<std::string, std::less<>> known_;
};

/// @throws InputError with the line for text that is not YAML.
YAML::Node load_yaml(const std::string& text, const std::string& name);

/// The text of a file, or of the built-in one of that name in a folder of configs/; `name` becomes what errors call it.
/// @throws InputError naming the built-in choices, SystemError
std::string find_config(const std::string& path_or_name, const std::string& folder, std::string& name);

/// Names, without ".yaml", of what is built in from a folder of configs/.
std::vector<std::string> config_names(const std::string& folder);

}  // namespace phasescan::sim
