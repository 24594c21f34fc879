/// Options structs by name: sections and keys of YAML, `config --dump`, docs/parameters.md. Built from each struct's
/// `visit`.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "io/nearest_word.hpp"
#include "phasescan/core/options.hpp"

namespace phasescan {

/// One option that can be set and read as text.
struct OptionEntry {
  std::string section;
  std::string name;
  std::string unit;
  std::string meaning;
  std::string bounds;  ///< "0..1", ">= 0", "16..2048, even, >= size", or empty
  std::string default_value;
  std::function<std::string()> get;
  /// @throws std::invalid_argument saying what was expected; the option is unchanged then.
  std::function<void(const std::string&)> set;
  std::string at_least;  ///< option of the same section that this one must not be below, or empty
};

/// All options of some structs, by section. Refers to the structs given to `add`: they must outlive the table.
class OptionTable {
 public:
  /// Adds a section; its defaults are those of a new Options.
  template <class Options>
  void add(std::string_view section, Options& options);

  /// A section's earlier name: files that have it are still understood.
  void add_alias(std::string_view earlier, std::string_view section);

  /// Reads `section: {option: value}` from YAML. @throws InputError with the line for text that is not YAML, an unknown
  /// section or option, one that stands twice, and a value of the wrong type, outside its bounds or below another one
  /// that it must not be below; SystemError.
  void load_file(const std::string& path);
  void load_text(const std::string& yaml, const std::string& file_name);

  /// YAML of all sections, or of one: each option with its value and, as a comment, default, unit, bounds and meaning.
  /// Loading it gives the same options. @throws std::invalid_argument for an unknown section.
  std::string dump(std::string_view section = "") const;

  const std::vector<OptionEntry>& entries() const { return entries_; }
  /// Sections that what was loaded names, by their present names.
  const std::vector<std::string>& loaded_sections() const { return loaded_sections_; }
  /// Options that what was loaded names, as "section.name".
  const std::vector<std::string>& loaded_options() const { return loaded_options_; }
  /// Null for an option that does not exist.
  const OptionEntry* find(std::string_view section, std::string_view name) const;

 private:
  std::string current_name(std::string_view section) const;
  std::vector<std::string> sections() const;

  std::vector<std::string> loaded_sections_, loaded_options_;
  std::vector<OptionEntry> entries_;
  std::vector<std::pair<std::string, std::string>> aliases_;
};

namespace detail {

std::string option_text(bool value);
std::string option_text(int value);
std::string option_text(double value);
inline std::string option_text(const std::string& value) {
  return value;
}
template <class E>
requires std::is_enum_v<E> std::string option_text(E value) {
  return std::string(to_string(value));
}

void set_option(bool& out, const std::string& text, const OptionInfo& info);
void set_option(int& out, const std::string& text, const OptionInfo& info);
void set_option(double& out, const std::string& text, const OptionInfo& info);
inline void set_option(std::string& out, const std::string& text, const OptionInfo&) {
  out = text;
}
template <class E>
requires std::is_enum_v<E>
void set_option(E& out, const std::string& text, const OptionInfo&) {
  out = enum_from_word<E>(text);
}

std::string bounds_text(const OptionInfo& info);

}  // namespace detail

template <class Options>
void OptionTable::add(std::string_view section, Options& options) {
  const std::size_t first = entries_.size();
  Options::visit(options, [&](std::string_view name, auto& value, const OptionInfo& info) {
    auto* member = &value;
    entries_.push_back({std::string(section), std::string(name), std::string(info.unit), std::string(info.meaning),
                        std::is_arithmetic_v<std::decay_t<decltype(value)>> ? detail::bounds_text(info) : "", "",
                        [member] { return detail::option_text(*member); },
                        [member, info](const std::string& text) { detail::set_option(*member, text, info); },
                        std::string(info.at_least)});
  });
  Options defaults;
  std::size_t i = first;
  Options::visit(defaults, [&](std::string_view, const auto& value, const OptionInfo&) {
    entries_[i++].default_value = detail::option_text(value);
  });
}

}  // namespace phasescan
