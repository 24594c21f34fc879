/// The one door through which YAML is read: bounded in size, depth and number of documents, mistakes told by line.
#pragma once

#include <yaml-cpp/yaml.h>

#include <cstddef>
#include <string>

namespace phasescan {

/// What a YAML text may hold. The defaults fit every settings file; a list of files or a world may have more values.
struct YamlBounds {
  std::size_t bytes = std::size_t{1} << 20;
  std::size_t values = 200'000;  ///< keys, values, lists and maps together
  std::size_t depth = 32;        ///< lists and maps within each other
};

/// The one document of a text, or a null node where it holds none. `name` is what errors call the text.
///
/// Reads the text twice: first only counting, because yaml-cpp 0.7 goes on for ever over text that begins no document
/// ("," gives one empty document after the other), then building the nodes.
/// @throws InputError with the line for text that is not YAML, a second document and what is beyond the bounds.
YAML::Node parse_yaml(const std::string& text, const std::string& name, const YamlBounds& bounds = {});

/// The same for a file. @throws as parse_yaml and read_file.
YAML::Node read_yaml(const std::string& path, const YamlBounds& bounds = {});

}  // namespace phasescan
