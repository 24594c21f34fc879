#include "config/option_table.hpp"

#include <algorithm>
#include <map>

#include "phasescan/io/error.hpp"
#include "io/file.hpp"
#include "io/nearest_word.hpp"
#include "io/number.hpp"
#include "io/yaml.hpp"

namespace phasescan {
namespace detail {
namespace {

std::string range_text(const OptionInfo& info) {
  const bool low = std::isfinite(info.min), high = std::isfinite(info.max);
  if (low && high) return option_text(info.min) + ".." + option_text(info.max);
  if (low) return ">= " + option_text(info.min);
  return high ? "<= " + option_text(info.max) : "";
}

template <class T>
void set_number(T& out, const std::string& text, const OptionInfo& info, const char* kind) {
  const auto value = parse_number<T>(text);
  if (!value) throw std::invalid_argument("is " + quote_text(text) + "; expected " + kind);
  const auto number = static_cast<double>(*value);
  if (!(number >= info.min && number <= info.max)) {
    throw std::invalid_argument("is " + text + "; expected " + range_text(info) +
                                (info.unit.empty() ? "" : " " + std::string(info.unit)));
  }
  if (info.even && std::fmod(number, 2.0) != 0.0)
    throw std::invalid_argument("is " + text + "; expected an even number");
  out = *value;
}

}  // namespace

std::string option_text(bool value) {
  return value ? "true" : "false";
}
std::string option_text(int value) {
  return std::to_string(value);
}
std::string option_text(double value) {
  std::string out;
  append_number(out, value);
  return out;
}

void set_option(bool& out, const std::string& text, const OptionInfo&) {
  if (text != "true" && text != "false")
    throw std::invalid_argument("is " + quote_text(text) + "; expected true or false");
  out = text == "true";
}
void set_option(int& out, const std::string& text, const OptionInfo& info) {
  set_number(out, text, info, "a whole number");
}
void set_option(double& out, const std::string& text, const OptionInfo& info) {
  set_number(out, text, info, "a number");
}

std::string bounds_text(const OptionInfo& info) {
  std::string text = range_text(info);
  if (info.even) text += text.empty() ? "even" : ", even";
  if (!info.at_least.empty()) text += (text.empty() ? ">= " : ", >= ") + std::string(info.at_least);
  return text;
}

}  // namespace detail

namespace {

long line_of(const YAML::Node& node) {
  return node.Mark().is_null() ? 1 : node.Mark().line + 1;
}

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const auto& word : words) out += (out.empty() ? "" : ", ") + word;
  return out;
}

std::string key_of(const YAML::Node& key, const std::string& file) {
  if (!key.IsScalar())
    throw InputError(file, line_of(key), "a key is no plain word; expected section: {option: value}");
  return key.Scalar();
}

// A string that YAML would read as something else stands in quotes.
std::string yaml_value(const std::string& text) {
  const bool plain = !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '-' ||
           c == '_' || c == '+' || c == '/';
  });
  if (plain && text != "-") return text;
  std::string out = "\"";
  for (const char c : text) out += (c == '"' || c == '\\') ? std::string("\\") + c : std::string(1, c);
  return out + "\"";
}

}  // namespace

void OptionTable::add_alias(std::string_view earlier, std::string_view section) {
  aliases_.emplace_back(earlier, section);
}

std::string OptionTable::current_name(std::string_view section) const {
  const auto alias = std::find_if(aliases_.begin(), aliases_.end(), [&](const auto& a) { return a.first == section; });
  return alias == aliases_.end() ? std::string(section) : alias->second;
}

const OptionEntry* OptionTable::find(std::string_view section, std::string_view name) const {
  const std::string current = current_name(section);
  const auto found = std::find_if(entries_.begin(), entries_.end(),
                                  [&](const OptionEntry& e) { return e.section == current && e.name == name; });
  return found == entries_.end() ? nullptr : &*found;
}

std::vector<std::string> OptionTable::sections() const {
  std::vector<std::string> names;
  for (const auto& entry : entries_) {
    if (names.empty() || names.back() != entry.section) names.push_back(entry.section);
  }
  return names;
}

void OptionTable::load_file(const std::string& path) {
  load_text(read_file(path, YamlBounds().bytes), path);
}

void OptionTable::load_text(const std::string& yaml, const std::string& file) {
  const YAML::Node root = parse_yaml(yaml, file);
  if (root.IsNull()) return;
  if (!root.IsMap()) throw InputError(file, line_of(root), "is no map; expected section: {option: value}");
  std::map<std::string, long> seen;  // section, section.option: its line
  for (const auto& part : root) {
    const std::string section = current_name(key_of(part.first, file));
    const auto names = sections();
    if (std::find(names.begin(), names.end(), section) == names.end()) {
      throw InputError(file, line_of(part.first),
                       "unknown section " + quote_text(section) + "; expected one of " + joined(names) +
                           did_you_mean(section, std::span<const std::string>(names)));
    }
    if (!seen.emplace(section, line_of(part.first)).second)
      throw InputError(file, line_of(part.first), "section " + quote_text(section) + " stands twice; expected once");
    loaded_sections_.push_back(section);
    if (part.second.IsNull()) continue;
    if (!part.second.IsMap())
      throw InputError(file, line_of(part.second),
                       "section " + quote_text(section) + " is no map; expected option: value lines");
    for (const auto& item : part.second) {
      const std::string name = key_of(item.first, file);
      const OptionEntry* option = find(section, name);
      if (option == nullptr) {
        std::vector<std::string> options;
        for (const auto& entry : entries_) {
          if (entry.section == section) options.push_back(entry.name);
        }
        throw InputError(file, line_of(item.first),
                         "unknown option " + quote_text(section + "." + name) + "; expected one of " + joined(options) +
                             did_you_mean(name, std::span<const std::string>(options)));
      }
      if (!seen.emplace(section + "." + name, line_of(item.second)).second) {
        throw InputError(file, line_of(item.first), section + "." + name + " stands twice; expected once");
      }
      if (!item.second.IsScalar())
        throw InputError(file, line_of(item.second), section + "." + name + " has no plain value; expected one");
      try {
        option->set(item.second.Scalar());
      } catch (const std::invalid_argument& error) {
        throw InputError(file, line_of(item.second), section + "." + name + " " + error.what());
      }
      loaded_options_.push_back(section + "." + name);
    }
  }
  for (const OptionEntry& entry : entries_) {
    const OptionEntry* least = entry.at_least.empty() ? nullptr : find(entry.section, entry.at_least);
    if (least == nullptr || *parse_number<double>(entry.get()) >= *parse_number<double>(least->get())) continue;
    // The later of the two lines spoiled it; one that does not stand in the file is a default.
    const std::string name = entry.section + "." + entry.name, other = least->section + "." + least->name;
    const long line = std::max(seen.contains(name) ? seen[name] : 0, seen.contains(other) ? seen[other] : 0);
    throw InputError(file, std::max(line, 1L),
                     name + " is " + entry.get() + "; expected at least " + other + ", " + least->get() +
                         (seen.contains(other) ? "" : " by default"));
  }
}

std::string OptionTable::dump(std::string_view asked_for) const {
  const auto names = sections();
  const std::string section = current_name(asked_for);
  if (!section.empty() && std::find(names.begin(), names.end(), section) == names.end()) {
    throw std::invalid_argument("unknown section " + quote_text(section) + "; expected one of " + joined(names) +
                                did_you_mean(section, std::span<const std::string>(names)));
  }
  std::string out, current;
  for (const auto& entry : entries_) {
    if (!section.empty() && entry.section != section) continue;
    if (entry.section != current) {
      out += (out.empty() ? "" : "\n") + entry.section + ":\n";
      current = entry.section;
    }
    std::string line = "  " + entry.name + ": " + yaml_value(entry.get());
    line.resize(std::max<std::size_t>(line.size(), 36), ' ');
    out += line + "  # default " + yaml_value(entry.default_value) + (entry.unit.empty() ? "" : " " + entry.unit) +
           (entry.bounds.empty() ? "" : " (" + entry.bounds + ")") + ": " + entry.meaning + "\n";
  }
  return out;
}

}  // namespace phasescan
