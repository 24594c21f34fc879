/// How an options struct describes itself: one `visit` per struct is the only source for defaults, YAML keys, flags,
/// `config --dump` and validation.
///
/// A struct of options has plain members with defaults and
///
///   template <class Self, class Visitor>
///   static void visit(Self& self, Visitor&& v) {
///     v("dmax_m", self.dmax_m, OptionInfo{"m", "range beyond which returns are left out", 0.1, 200});
///   }
///
/// Members are bool, int, double, std::string or an enum for which `enum_names` is specialised.
#pragma once

#include <cmath>
#include <concepts>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>

namespace phasescan {

/// What is known of one option beside its value. Bounds are inclusive and apply to numbers only.
struct OptionInfo {
  std::string_view unit;
  std::string_view meaning;
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool even = false;            ///< odd numbers are refused
  std::string_view at_least{};  ///< another number of the same struct that this one must not be below
};

/// Names of an enum's values, in order from 0: what YAML and flags say. Specialise for each enum used as an option.
template <class E>
std::span<const std::string_view> enum_names() = delete;

/// Today's name of a value that was once called otherwise; any other text as it is. Specialise where a name changed.
template <class E>
constexpr std::string_view current_enum_name(std::string_view text) {
  return text;
}

template <class E>
requires std::is_enum_v<E> std::string_view to_string(E value) {
  return enum_names<E>()[static_cast<std::size_t>(value)];
}

/// Parses an enum name. @throws std::invalid_argument naming the choices.
template <class E>
requires std::is_enum_v<E> E enum_from_string(std::string_view text) {
  const auto names = enum_names<E>();
  const std::string_view current = current_enum_name<E>(text);
  std::string choices;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i] == current) return static_cast<E>(i);
    choices += (i ? ", " : "") + std::string(names[i]);
  }
  throw std::invalid_argument("'" + std::string(text) + "' is not one of " + choices);
}

/// What is wrong with a value by itself: "is outside 0..5 m"; empty for one within its bounds.
inline std::string option_complaint(double value, const OptionInfo& info) {
  if (!(value >= info.min && value <= info.max)) {
    return "is outside " + std::to_string(info.min) + ".." + std::to_string(info.max) +
           (info.unit.empty() ? "" : " " + std::string(info.unit));
  }
  return info.even && std::fmod(value, 2.0) != 0.0 ? "is odd; expected an even number" : "";
}

/// The number among the members that is called `name`; NaN where there is none.
template <class Options>
double option_number(const Options& options, std::string_view name) {
  double number = std::numeric_limits<double>::quiet_NaN();
  Options::visit(options, [&](std::string_view other, const auto& value, const OptionInfo&) {
    if constexpr (std::is_arithmetic_v<std::decay_t<decltype(value)>>) {
      if (other == name) number = static_cast<double>(value);
    }
  });
  return number;
}

/// Checks every numeric member against its bounds, and against the one it must not be below.
/// @throws std::invalid_argument "section.field: value 7 is outside 0..5 m".
template <class Options>
void validate_options(std::string_view section, const Options& options) {
  Options::visit(options, [&](std::string_view name, const auto& value, const OptionInfo& info) {
    using T = std::decay_t<decltype(value)>;
    if constexpr (std::is_arithmetic_v<T> && !std::is_same_v<T, bool>) {
      const double number = static_cast<double>(value);
      std::string complaint = option_complaint(number, info);
      if (complaint.empty() && !info.at_least.empty() && number < option_number(options, info.at_least))
        complaint = "is below " + std::string(section) + "." + std::string(info.at_least);
      if (!complaint.empty()) {
        throw std::invalid_argument(std::string(section) + "." + std::string(name) + ": value " +
                                    std::to_string(value) + " " + complaint);
      }
    }
  });
}

}  // namespace phasescan
