#include "sim/yaml_fields.hpp"

#include <filesystem>

#include "io/file.hpp"
#include "io/nearest_word.hpp"
#include "sim/embedded.hpp"

namespace phasescan::sim {
namespace {

/// Whether a built-in file belongs to a folder of simulator settings; the methods' own settings (paper-*.yaml) are
/// none.
bool is_of(const std::filesystem::path& file, const std::string& folder) {
  return file.parent_path() == folder && !file.filename().string().starts_with("paper-");
}

}  // namespace

YAML::Node load_yaml(const std::string& text, const std::string& name) {
  // A world may be a whole floor plan of walls.
  return parse_yaml(text, name, {std::size_t{1} << 24, 2'000'000, 32});
}

std::string find_config(const std::string& path_or_name, const std::string& folder, std::string& name) {
  // A bare name is the built-in one whatever lies in the folder the user happens to be in; with ".yaml" a file there
  // goes first.
  const EmbeddedFile* built_in = nullptr;
  std::string choices;
  for (const EmbeddedFile& file : embedded_files()) {
    const std::filesystem::path path{std::string(file.name)};
    if (!is_of(path, folder)) continue;
    if (path.stem() == path_or_name || path.filename() == path_or_name) built_in = &file;
    choices += (choices.empty() ? "" : ", ") + path.stem().string();
  }
  const bool bare = built_in && std::filesystem::path(path_or_name).extension().empty();
  if (!bare && std::filesystem::exists(path_or_name)) {
    name = path_or_name;
    return read_file(path_or_name);
  }
  if (!built_in) {
    const std::vector<std::string> names = config_names(folder);
    throw InputError(
        path_or_name, 0,
        "no such file, and not one of " + choices + did_you_mean(path_or_name, std::span<const std::string>(names)));
  }
  name = std::filesystem::path(std::string(built_in->name)).filename().string();
  return std::string(built_in->text);
}

std::vector<std::string> config_names(const std::string& folder) {
  std::vector<std::string> names;
  for (const EmbeddedFile& file : embedded_files()) {
    const std::filesystem::path path{std::string(file.name)};
    if (is_of(path, folder)) names.push_back(path.stem().string());
  }
  return names;
}

}  // namespace phasescan::sim
