#include "slam/option_text.hpp"

#include <charconv>
#include <map>
#include <type_traits>

#include "phasescan/slam/state.hpp"
#include "state/fields.hpp"

namespace phasescan {
namespace {

/// Calls v(section, name, value) for every option of a run.
template <class Options, class Visitor>
void visit_all(Options& options, Visitor&& v) {
  const auto section = [&v](std::string_view name, auto& values) {
    std::remove_cvref_t<decltype(values)>::visit(
        values, [&](std::string_view option, auto& value, const OptionInfo&) { v(name, option, value); });
  };
  SlamOptions::visit_sections(options, section);
  MatchOptions::visit_sections(options.match, section);
}

template <class T>
std::string text_of(const T& value) {
  if constexpr (std::is_same_v<T, bool>) {
    return value ? "true" : "false";
  } else if constexpr (std::is_enum_v<T>) {
    return std::string(to_string(value));
  } else {
    char text[64];
    return {text, std::to_chars(text, text + sizeof(text), value).ptr};
  }
}

template <class T>
bool parse(const std::string& text, T& value) {
  if constexpr (std::is_same_v<T, bool>) {
    value = text == "true";
    return value || text == "false";
  } else if constexpr (std::is_enum_v<T>) {
    try {
      value = enum_from_string<T>(text);
      return true;
    } catch (const std::invalid_argument&) {
      return false;
    }
  } else {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size();
  }
}

std::string full_name(std::string_view section, std::string_view option) {
  return std::string(section) + "." + std::string(option);
}

std::map<std::string, std::string> texts_of(const SlamOptions& options) {
  std::map<std::string, std::string> texts;
  visit_all(options, [&](std::string_view section, std::string_view option, const auto& value) {
    texts[full_name(section, option)] = text_of(value);
  });
  return texts;
}

}  // namespace

std::string format_options(const SlamOptions& options) {
  std::string out;
  for (const auto& [name, text] : texts_of(options)) out += name + "=" + text + "\n";
  return out;
}

SlamOptions parse_options(std::string_view text) {
  std::map<std::string, std::string> texts;
  while (!text.empty()) {
    const std::size_t end = text.find('\n'), equals = text.find('=');
    if (end == std::string_view::npos || equals >= end)
      throw StateFormatError("is damaged: its options are no options");
    texts[std::string(text.substr(0, equals))] = text.substr(equals + 1, end - equals - 1);
    text.remove_prefix(end + 1);
  }
  SlamOptions options;
  visit_all(options, [&](std::string_view section, std::string_view option, auto& value) {
    const auto found = texts.find(full_name(section, option));
    if (found != texts.end() && !parse(found->second, value))
      throw StateFormatError("is damaged: its option " + found->first + " has no value");
  });
  try {
    options.validate();
  } catch (const std::invalid_argument& error) {
    throw StateFormatError(std::string("is damaged: its option ") + error.what());
  }
  return options;
}

OptionDifferences compare_options(const SlamOptions& now, const SlamOptions& before) {
  OptionDifferences out;
  const std::map<std::string, std::string> then = texts_of(before);
  for (const auto& [name, text] : texts_of(now)) {
    const std::string& was = then.at(name);
    // What is drawn at the end, and when a file is written, is no matter of going on.
    if (text == was || name.starts_with("map.") || name.starts_with("glass.") || name == "slam.autosave_s" ||
        name == "slam.session_gap_s" || name == "slam.largest_piece")
      continue;
    const bool fatal = name == "slam.bounded_memory" || name == "slam.polish";
    (fatal ? out.fatal : out.harmless).push_back(name + " " + text + ", was " + was);
  }
  return out;
}

}  // namespace phasescan
