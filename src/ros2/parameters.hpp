/// Options structs as parameters of a node: typed, with bounds and descriptions, changeable one by one.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "phasescan/core/options.hpp"

namespace phasescan::ros2 {

using ParameterValue = std::variant<bool, std::int64_t, double, std::string>;

/// "bool", "integer", "number", "text".
std::string_view type_name(const ParameterValue& value);

struct Parameter {
  std::string name;         ///< "odometry.cell_m"
  std::string description;  ///< meaning and unit; of an enum its choices too
  ParameterValue default_value;
  std::optional<double> min, max;  ///< inclusive
  bool while_running = false;      ///< may be changed at any time; else before the node is configured
  std::function<ParameterValue()> get;
  /// @throws std::invalid_argument naming parameter and bounds; nothing has changed then
  std::function<void(const ParameterValue&)> set;
};

/// Refers to the structs given to `add`: they must outlive the table.
class ParameterTable {
 public:
  /// @param prefix         before each name, with its dot; empty: none
  /// @param while_running  whether these may be changed while the node runs
  template <class Options>
  void add(const std::string& prefix, Options& options, bool while_running);
  /// A parameter that may, or may not, be changed while running, against the rule of its struct.
  void set_while_running(std::string_view name, bool allowed);

  const std::vector<Parameter>& entries() const { return entries_; }
  /// Null for one that does not exist.
  const Parameter* find(std::string_view name) const;
  /// Sets a parameter. A whole number is taken where a number is expected.
  /// @param running  whether the node runs
  /// @throws std::invalid_argument naming the parameter: unknown, wrong type, out of bounds, not now
  void set(std::string_view name, const ParameterValue& value, bool running);

 private:
  std::vector<Parameter> entries_;
};

namespace detail {

template <class T>
ParameterValue to_value(const T& member) {
  if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, double> || std::is_same_v<T, std::string>) {
    return member;
  } else if constexpr (std::is_integral_v<T>) {
    return static_cast<std::int64_t>(member);
  } else {
    return std::string(to_string(member));
  }
}

/// @throws std::invalid_argument without the parameter's name
void check_bounds(double value, const OptionInfo& info);
[[noreturn]] void wrong_type(const ParameterValue& value, std::string_view expected);

template <class T>
T from_value(const ParameterValue& value, const OptionInfo& info) {
  if constexpr (std::is_same_v<T, bool>) {
    if (const bool* given = std::get_if<bool>(&value)) return *given;
    wrong_type(value, "true or false");
  } else if constexpr (std::is_same_v<T, std::string>) {
    if (const std::string* given = std::get_if<std::string>(&value)) return *given;
    wrong_type(value, "text");
  } else if constexpr (std::is_enum_v<T>) {
    if (const std::string* given = std::get_if<std::string>(&value)) return enum_from_string<T>(*given);
    wrong_type(value, "text");
  } else {
    const std::int64_t* whole = std::get_if<std::int64_t>(&value);
    const double* real = std::get_if<double>(&value);
    if (whole == nullptr && (real == nullptr || std::is_integral_v<T>))
      wrong_type(value, std::is_integral_v<T> ? "a whole number" : "a number");
    check_bounds(whole != nullptr ? static_cast<double>(*whole) : *real, info);
    return whole != nullptr ? static_cast<T>(*whole) : static_cast<T>(*real);
  }
}

std::string describe(const OptionInfo& info, std::span<const std::string_view> choices);

}  // namespace detail

template <class Options>
void ParameterTable::add(const std::string& prefix, Options& options, bool while_running) {
  Options* const all = &options;
  Options::visit(options, [&](std::string_view name, auto& member, const OptionInfo& info) {
    using T = std::decay_t<decltype(member)>;
    Parameter entry;
    entry.name = prefix + std::string(name);
    std::span<const std::string_view> choices;
    if constexpr (std::is_enum_v<T>) choices = enum_names<T>();
    entry.description = detail::describe(info, choices);
    if constexpr (std::is_arithmetic_v<T> && !std::is_same_v<T, bool>) {
      if (std::isfinite(info.min)) entry.min = info.min;
      if (std::isfinite(info.max)) entry.max = info.max;
    }
    entry.while_running = while_running;
    T* const at = &member;
    entry.get = [at] { return detail::to_value(*at); };
    entry.set = [at, all, info, section = prefix](const ParameterValue& value) {
      const T before = *at;
      *at = detail::from_value<T>(value, info);
      try {
        validate_options(section.empty() ? "" : section.substr(0, section.size() - 1), *all);
      } catch (...) {
        *at = before;
        throw;
      }
    };
    entries_.push_back(std::move(entry));
  });
  const Options defaults;
  std::size_t i = entries_.size();
  Options::visit(defaults, [&](std::string_view, const auto&, const OptionInfo&) { --i; });
  Options::visit(defaults, [&](std::string_view, const auto& member, const OptionInfo&) {
    entries_[i++].default_value = detail::to_value(member);
  });
}

}  // namespace phasescan::ros2
