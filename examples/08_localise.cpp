// Makes a map of a log, then finds the log's scans on it with no guess: LOG.
#include <cstdio>
#include <exception>
#include <phasescan/io/log.hpp>
#include <phasescan/localize/localizer.hpp>
#include <phasescan/slam/slam.hpp>
#include <utility>

using namespace phasescan;

int main(int argc, char** argv) try {
  if (argc < 2) {
    std::fprintf(stderr, "usage: %s LOG\n", argv[0]);
    return 2;
  }
  Slam slam;
  const auto log = open_log(argv[1]);
  while (auto entry = log->next()) slam.add(to_measurement(std::move(*entry)));
  const SlamResult result = slam.finish();

  const LocalizationMap map = LocalizationMap::from_grid(result.map);
  std::printf("%.0f m2 free, described from %zu places\n", map.free_area_m2(), map.views());

  Localizer localizer(map);
  std::size_t scan = 0, right = 0;
  const auto again = open_log(argv[1]);
  while (auto entry = again->next()) {
    const LocalizationUpdate update = localizer.add(to_measurement(std::move(*entry)));
    const Pose2 mapped = result.scans[scan++].T_map_base;
    if (update.has_pose() && translation_distance(*update.T_map_base, mapped) < 0.1) ++right;
    if (scan % 20 == 1 && update.T_map_base) {
      std::printf("scan %zu: %s at %.2f %.2f, probability %.3f\n", scan, to_string(update.status), update.T_map_base->x,
                  update.T_map_base->y, update.confidence);
    }
  }
  std::printf("%zu of %zu scans where the map has them\n", right, scan);
  return right * 10 >= scan * 9 ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
