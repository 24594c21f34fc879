#include "live_saver.hpp"

#include <array>
#include <ctime>
#include <filesystem>
#include <stdexcept>

#include "io/file.hpp"
#include "live/priority.hpp"
#include "output/map_file.hpp"

namespace phasescan::app {

std::string name_of_now(const std::string& what) {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  ::localtime_r(&now, &local);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "-%Y%m%d-%H%M%S", &local);
  return what + text.data();
}

void LiveSaver::save(const std::string& name, const serve::CommandDone& done) {
  if (slam_.scans() == 0) throw std::runtime_error("there is nothing to save yet");
  if (busy_.exchange(true)) throw std::runtime_error("the last one is not written yet");
  try {
    const std::string file = name.empty() ? name_of_now("map") : name;
    make_folder(folder_);
    for (const char* end : {".pgm", ".yaml", ".png", ".state"})
      if (std::filesystem::exists(std::filesystem::path(folder_) / (file + end)))
        throw std::runtime_error(file + end + " is there already; choose another name");
    const SlamState state = slam_.checkpoint();
    if (worker_.joinable()) worker_.join();
    worker_ = std::thread([this, state, options = slam_.options(), file, done] {
      live::be_nicer(10);  // tracking comes first
      std::string failure;
      try {
        write({state, options}, file);
      } catch (const std::exception& error) {
        failure = error.what();
      }
      busy_ = false;
      done(failure.empty(), failure.empty() ? file + ".pgm, .yaml, .png and .state are saved" : failure);
    });
  } catch (...) {
    busy_ = false;
    throw;
  }
}

void LiveSaver::write(const SavedRun& run, const std::string& name) const {
  // The map as it would be at the end: the run goes on without this copy.
  const TrinaryMap map = Slam(run.state, run.options).finish().map;
  FileSet files(folder_);
  files.add(name + ".pgm", format_pgm(map));
  files.add(name + ".yaml", format_map_yaml(map, name + ".pgm"));
  files.add(name + ".png", format_png(map));
  files.commit();
  write_state((std::filesystem::path(folder_) / (name + ".state")).string(), run);
}

void LiveSaver::wait() {
  if (worker_.joinable()) worker_.join();
}

}  // namespace phasescan::app
