#include "ros2/parameters.hpp"

#include <algorithm>
#include <stdexcept>

namespace phasescan::ros2 {

std::string_view type_name(const ParameterValue& value) {
  static constexpr std::string_view kNames[] = {"true or false", "a whole number", "a number", "text"};
  return kNames[value.index()];
}

namespace detail {

void check_bounds(double value, const OptionInfo& info) {
  if (const std::string complaint = option_complaint(value, info); !complaint.empty())
    throw std::invalid_argument("value " + std::to_string(value) + " " + complaint);
}

void wrong_type(const ParameterValue& value, std::string_view expected) {
  throw std::invalid_argument("is " + std::string(type_name(value)) + "; expected " + std::string(expected));
}

std::string describe(const OptionInfo& info, std::span<const std::string_view> choices) {
  std::string out(info.meaning);
  if (!info.unit.empty()) out += " [" + std::string(info.unit) + "]";
  for (std::size_t i = 0; i < choices.size(); ++i) out += (i == 0 ? "; one of " : ", ") + std::string(choices[i]);
  return out;
}

}  // namespace detail

const Parameter* ParameterTable::find(std::string_view name) const {
  const auto found =
      std::find_if(entries_.begin(), entries_.end(), [&](const Parameter& entry) { return entry.name == name; });
  return found == entries_.end() ? nullptr : &*found;
}

void ParameterTable::set_while_running(std::string_view name, bool allowed) {
  for (Parameter& entry : entries_) {
    if (entry.name == name) entry.while_running = allowed;
  }
}

void ParameterTable::set(std::string_view name, const ParameterValue& value, bool running) {
  const Parameter* entry = find(name);
  if (entry == nullptr) throw std::invalid_argument(std::string(name) + ": there is no such parameter");
  if (running && !entry->while_running)
    throw std::invalid_argument(entry->name + ": can be changed only before the node is configured");
  try {
    entry->set(value);
  } catch (const std::invalid_argument& error) {
    const std::string text = error.what();
    throw std::invalid_argument(text.starts_with(entry->name + ":") ? text : entry->name + ": " + text);
  }
}

}  // namespace phasescan::ros2
