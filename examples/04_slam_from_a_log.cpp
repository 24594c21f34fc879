// Makes a map of a log of any readable format: LOG [MAP.pgm]. Loops and graph run beside tracking.
#include <cstdio>
#include <exception>
#include <fstream>
#include <phasescan/io/log.hpp>
#include <phasescan/slam/slam.hpp>
#include <string>
#include <utility>

using namespace phasescan;

// Told of what happens beside the scans.
struct Printer final : SlamObserver {
  void on_loop(const MapEdge& loop, bool accepted) override {
    std::printf("loop from keyframe %d to %d %s\n", loop.from, loop.to, accepted ? "accepted" : "taken out");
  }
  void on_warning(ScanId scan, const std::string&, const std::string& what, bool) override {
    std::printf("scan %lld: %s\n", static_cast<long long>(scan), what.c_str());
  }
};

// The map as a grey picture: black walls, white floor.
void write_pgm(const TrinaryMap& map, const std::string& path) {
  std::ofstream file(path, std::ios::binary);
  file << "P5\n" << map.width << " " << map.height << "\n255\n";
  for (int k = map.height - 1; k >= 0; --k) {
    for (int i = 0; i < map.width; ++i) {
      const CellState cell = map.at(i, k);
      file.put(static_cast<char>(cell == CellState::kOccupied ? 0 : cell == CellState::kFree ? 255 : 205));
    }
  }
}

int main(int argc, char** argv) try {
  if (argc < 2) {
    std::fprintf(stderr, "usage: %s LOG [MAP.pgm]\n", argv[0]);
    return 2;
  }
  ThreadExecutor executor;
  Printer printer;
  Slam slam(SlamOptions{}, Schedule::kDeterministic, &executor);
  slam.set_observer(&printer);
  const auto log = open_log(argv[1]);
  while (auto entry = log->next()) slam.add(to_measurement(std::move(*entry)));
  const SlamResult result = slam.finish();
  std::printf("%zu scans, %zu keyframes, %zu loops, map of %d x %d cells, %d pieces\n", result.scans.size(),
              result.keyframes.size(), result.loops.accepted, result.map.width, result.map.height, result.pieces);
  if (argc > 2) write_pgm(result.map, argv[2]);
  return result.keyframes.empty() ? 1 : 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
