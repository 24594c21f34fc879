// metadata.yaml of a rosbag2 folder beside one small recording.
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "fuzz_file.hpp"

namespace {

/// A folder of its own for the process, gone with it.
struct Folder {
  std::string path;
  Folder() {
    std::string name = std::filesystem::temp_directory_path().string() + "/phasescan-fuzz-XXXXXX";
    path = ::mkdtemp(name.data());
    std::ofstream(path + "/x_0.mcap", std::ios::binary) << "\x89MCAP0\r\n";
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Folder folder;
  const std::string yaml = folder.path + "/metadata.yaml";
  std::filesystem::remove(yaml);
  std::ofstream(yaml, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  phasescan::fuzz::read_log(folder.path);
  return 0;
}
