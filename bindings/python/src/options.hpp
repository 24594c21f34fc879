// Options from Python: keywords, and dicts by section, set through each struct's `visit`.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "bind.hpp"
#include "io/nearest_word.hpp"
#include "methods/any_options.hpp"
#include "phasescan/core/options.hpp"
#include "phasescan/localize/options.hpp"
#include "phasescan/slam/options.hpp"

namespace phasescan::python {

/// All that `match` and its kin read.
using MatcherOptions = AnyMatchOptions;

/// All that tracking reads, as a root of sections.
struct TrackingOptions {
  OdometryOptions odometry;

  template <class Self, class Visitor>
  static void visit_sections(Self& self, Visitor&& v) {
    v("odometry", self.odometry);
  }
};

/// All that SLAM reads, the matcher's sections among them.
struct MappingOptions {
  SlamOptions slam;

  template <class Self, class Visitor>
  static void visit_sections(Self& self, Visitor&& v) {
    SlamOptions::visit_sections(self.slam, v);
    v("match", self.slam.match.match);
    v("global", self.slam.match.global);
  }
};

/// All that localisation reads.
struct LocalizingOptions {
  LocalizeOptions localize;
  OdometryOptions odometry;

  template <class Self, class Visitor>
  static void visit_sections(Self& self, Visitor&& v) {
    v("localize", self.localize);
    v("odometry", self.odometry);
  }
};

/// What a value in Python means for a member. @throws std::invalid_argument "expected a number, got str"
void set_from_python(bool& out, py::handle value);
void set_from_python(int& out, py::handle value);
void set_from_python(double& out, py::handle value);
void set_from_python(std::string& out, py::handle value);
template <class E>
requires std::is_enum_v<E>
void set_from_python(E& out, py::handle value) {
  std::string text;
  set_from_python(text, value);
  out = enum_from_word<E>(text);
}

template <class T>
py::object to_python(const T& value) {
  if constexpr (std::is_enum_v<T>) {
    return py::str(std::string(to_string(value)));
  } else {
    return py::cast(value);
  }
}

/// Sets the member `name` of a section; false where it has none.
template <class Section>
bool set_member(Section& section, std::string_view section_name, std::string_view name, py::handle value) {
  bool found = false;
  Section::visit(section, [&](std::string_view member, auto& out, const OptionInfo&) {
    if (member != name) return;
    found = true;
    try {
      set_from_python(out, value);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(std::string(section_name) + "." + std::string(name) + ": " + error.what());
    }
  });
  return found;
}

template <class Section>
std::vector<std::string> member_names(const Section& section) {
  std::vector<std::string> names;
  Section::visit(section, [&](std::string_view name, const auto&, const OptionInfo&) { names.emplace_back(name); });
  return names;
}

/// `name`, without the underscore that keeps `global_` from being a keyword of Python.
inline std::string plain_name(py::handle key) {
  std::string name = py::str(key);
  if (name.size() > 1 && name.back() == '_') name.pop_back();
  return name == "mh" ? "global" : name;
}

template <class Section>
void set_section(Section& section, std::string_view section_name, const py::dict& values) {
  for (const auto& [key, value] : values) {
    const std::string name = py::str(key);
    if (!set_member(section, section_name, name, value))
      throw OptionError("no option '" + name + "' in section '" + std::string(section_name) + "'" +
                        did_you_mean(name, member_names(section)));
  }
}

/// One keyword: a section with a dict, or an option that stands in one section alone.
template <class Root>
void set_keyword(Root& root, py::handle key, py::handle value) {
  const std::string name = plain_name(key);
  std::vector<std::string> words, holders;
  bool done = false;
  Root::visit_sections(root, [&](std::string_view section_name, auto& section) {
    words.emplace_back(section_name);
    if (section_name == name && py::isinstance<py::dict>(value)) {
      set_section(section, section_name, py::reinterpret_borrow<py::dict>(value));
      done = true;
      return;
    }
    for (const std::string& member : member_names(section)) {
      if (member == name) holders.emplace_back(section_name);
      words.push_back(member);
    }
  });
  if (done) return;
  if (holders.empty()) {
    const bool is_section = std::find(words.begin(), words.end(), name) != words.end();
    throw OptionError(is_section ? name + ": is a section; expected a dict of its options, got " + type_name(value)
                                 : "no option '" + name + "'" + did_you_mean(name, words));
  }
  // A name that the default matcher has is its own, whatever methods for comparison have of that name.
  if (std::find(holders.begin(), holders.end(), "global") != holders.end()) holders = {"global"};
  if (holders.size() > 1) {
    std::string list;
    for (const std::string& holder : holders) list += (list.empty() ? "" : " and ") + holder;
    throw OptionError("'" + name + "' stands in sections " + list + "; expected " + holders.front() + "={'" + name +
                      "': ...}");
  }
  Root::visit_sections(root, [&](std::string_view section_name, auto& section) {
    if (section_name == holders.front()) set_member(section, section_name, name, value);
  });
}

/// What `options` says (nothing, a dict by section, or a Root), then the keywords over it, all within bounds.
template <class Root>
Root options_from(const py::object& options, const py::kwargs& keywords) {
  Root root;
  if (py::isinstance<Root>(options)) {
    root = options.cast<const Root&>();
  } else if (py::isinstance<py::dict>(options)) {
    for (const auto& [key, value] : py::reinterpret_borrow<py::dict>(options)) set_keyword(root, key, value);
  } else if (!options.is_none()) {
    throw std::invalid_argument("options: expected a dict or an object of options, got " + type_name(options));
  }
  for (const auto& [key, value] : keywords) set_keyword(root, key, value);
  Root::visit_sections(root, [](std::string_view name, const auto& section) { validate_options(name, section); });
  return root;
}

/// {section: {option: value}}.
template <class Root>
py::dict options_dict(const Root& root) {
  py::dict all;
  Root::visit_sections(root, [&](std::string_view section_name, const auto& section) {
    py::dict values;
    std::decay_t<decltype(section)>::visit(section, [&](std::string_view name, const auto& value, const OptionInfo&) {
      values[py::str(std::string(name))] = to_python(value);
    });
    all[py::str(std::string(section_name))] = values;
  });
  return all;
}

}  // namespace phasescan::python
