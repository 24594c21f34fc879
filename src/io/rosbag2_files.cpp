#include "io/rosbag2_files.hpp"

#include <algorithm>
#include <filesystem>

#include "phasescan/io/error.hpp"
#include "io/yaml.hpp"

namespace phasescan {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostMetadataBytes = std::size_t{1} << 24;
constexpr std::size_t kMostFiles = 100'000;

/// metadata.yaml names the files relative to the folder; before version 4 with the folder's own name in front.
std::string split_path(const fs::path& folder, const std::string& stated) {
  for (const fs::path& candidate : {folder / stated, folder / (stated + ".zstd"), folder / fs::path(stated).filename(),
                                    folder / (fs::path(stated).filename().string() + ".zstd")}) {
    std::error_code error;
    if (fs::is_regular_file(candidate, error)) return candidate.string();
  }
  return (folder / stated).string();
}

Rosbag2Files read_metadata(const fs::path& folder, const fs::path& metadata) {
  Rosbag2Files out;
  try {
    const YAML::Node root = read_yaml(metadata.string(), {kMostMetadataBytes, 8 * kMostFiles, 32});
    if (!root.IsMap()) throw InputError(metadata.string(), 1, "is no map; expected the metadata of rosbag2");
    const YAML::Node info = root["rosbag2_bagfile_information"];
    const YAML::Node paths = info["relative_file_paths"];
    if (!paths || !paths.IsSequence()) {
      throw InputError(metadata.string(), 0, "no relative_file_paths; expected the metadata of rosbag2");
    }
    for (const YAML::Node& path : paths) {
      if (out.files.size() < kMostFiles) out.files.push_back(split_path(folder, path.as<std::string>()));
    }
    out.whole = info["message_count"].IsDefined();
    for (const char* name : {"version", "storage_identifier", "compression_format", "compression_mode"}) {
      const YAML::Node value = info[name];
      if (value && value.IsScalar() && !value.Scalar().empty()) out.about[name] = value.Scalar();
    }
  } catch (const SystemError& problem) {  // not readable: the files are there all the same
    throw InputError(metadata.string(), 0, std::string(problem.what()) + "; expected the metadata of rosbag2");
  } catch (const YAML::Exception& problem) {
    throw InputError(metadata.string(), problem.mark.line + 1, problem.msg + "; expected the metadata of rosbag2");
  }
  return out;
}

/// The name without folder and .zstd: x_0.db3 and x_0.db3.zstd are the same file.
std::string bare_name(const std::string& path) {
  const fs::path name = fs::path(path).filename();
  return (name.extension() == ".zstd" ? name.stem() : name).string();
}

/// The name of the recording that a split belongs to: x of x_0.db3.
std::string recording_name(const std::string& path) {
  const std::string stem = fs::path(bare_name(path)).stem().string();
  const auto end = stem.find_last_not_of("0123456789");
  return end != std::string::npos && stem[end] == '_' ? stem.substr(0, end) : stem;
}

/// rosbag2 numbers its splits without leading zeros: compare runs of digits by value.
bool natural_less(const std::string& a, const std::string& b) {
  const auto number_at = [](const std::string& text) {
    const auto end = text.find_last_of("0123456789");
    if (end == std::string::npos) return std::string();
    const auto before = text.find_last_not_of("0123456789", end);
    return text.substr(before == std::string::npos ? 0 : before + 1,
                       end - (before == std::string::npos ? 0 : before + 1) + 1);
  };
  const std::string x = number_at(fs::path(a).stem().stem().string());
  const std::string y = number_at(fs::path(b).stem().stem().string());
  if (x.size() != y.size()) return x.size() < y.size();
  return x != y ? x < y : a < b;
}

Rosbag2Files list_folder(const fs::path& folder) {
  Rosbag2Files out;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end && out.files.size() < kMostFiles;
       it.increment(error)) {
    const std::string name = it->path().filename().string();
    const bool ours = name.ends_with(".db3") || name.ends_with(".mcap") || name.ends_with(".db3.zstd") ||
                      name.ends_with(".mcap.zstd");
    if (ours) out.files.push_back(it->path().string());
  }
  if (error) throw SystemError(folder.string(), error.message());
  std::sort(out.files.begin(), out.files.end(), natural_less);
  const auto same = [](const std::string& a, const std::string& b) { return bare_name(a) == bare_name(b); };
  out.files.erase(std::unique(out.files.begin(), out.files.end(), same), out.files.end());
  out.about["metadata.yaml"] = "not used: the files were taken by their numbers";
  return out;
}

/// Metadata that were cut off name too few files: the others are read as well.
void add_unnamed_files(const std::deque<std::string>& present, const std::string& metadata, Rosbag2Files& stated) {
  for (const std::string& path : present) {
    const auto same = [&path](const std::string& named) { return bare_name(named) == bare_name(path); };
    if (std::any_of(stated.files.begin(), stated.files.end(), same)) continue;
    stated.damages.push_back(
        {"file not named", path, "is not named in " + metadata + ", which was cut off; it is read as well"});
    stated.files.push_back(path);
  }
}

}  // namespace

Rosbag2Files find_rosbag2_files(const std::string& folder) {
  const fs::path metadata = fs::path(folder) / "metadata.yaml";
  std::error_code error;
  const bool has_metadata = fs::exists(metadata, error);
  Rosbag2Files present = list_folder(folder);
  if (has_metadata) {
    try {
      Rosbag2Files stated = read_metadata(folder, metadata);
      if (!stated.whole) add_unnamed_files(present.files, metadata.string(), stated);
      if (!stated.files.empty()) return stated;
    } catch (const InputError& problem) {
      if (present.files.empty()) throw;
      present.damages.push_back(
          {"bad metadata", problem.file(), problem.reason() + "; the files were taken by their numbers"});
    }
  }
  if (present.files.empty())
    throw InputError(folder, 0, "is a folder without metadata.yaml, .db3 or .mcap; expected a rosbag2 recording");
  const auto of_another = [&present](const std::string& file) {
    return recording_name(file) != recording_name(present.files.front());
  };
  if (std::any_of(present.files.begin(), present.files.end(), of_another))
    throw InputError(folder, 0, "is a folder of several recordings without metadata.yaml; expected one of its files");
  return present;
}

}  // namespace phasescan
