// How far a map's trajectory is from the truth: LOG TRUTH.tum. `phasescan eval` says the same and more.
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <map>
#include <phasescan/io/log.hpp>
#include <phasescan/slam/slam.hpp>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

using namespace phasescan;

namespace {

// A TUM file: stamp x y z qx qy qz qw a line.
std::map<Stamp, Eigen::Vector2d> read_tum(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + ": cannot be read");
  std::map<Stamp, Eigen::Vector2d> places;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    double seconds = 0.0, x = 0.0, y = 0.0;
    if (words >> seconds >> x >> y) places[stamp_from_seconds(seconds)] = {x, y};
  }
  return places;
}

// The true place at a stamp, within half a millisecond of it; null: none.
const Eigen::Vector2d* at(const std::map<Stamp, Eigen::Vector2d>& places, Stamp stamp) {
  const auto next = places.lower_bound(stamp - 500'000);
  return next != places.end() && next->first <= stamp + 500'000 ? &next->second : nullptr;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 3) {
    std::fprintf(stderr, "usage: %s LOG TRUTH.tum\n", argv[0]);
    return 2;
  }
  Slam slam;
  const auto log = open_log(argv[1]);
  while (auto entry = log->next()) slam.add(to_measurement(std::move(*entry)));
  const SlamResult result = slam.finish();
  const auto truth = read_tum(argv[2]);
  std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> pairs;  // on the map, and in truth
  for (const ScanResult& scan : result.scans) {
    const Eigen::Vector2d* place = at(truth, scan.stamp);
    if (place && scan.on_map) pairs.emplace_back(scan.T_map_base.translation(), *place);
  }
  if (pairs.size() < 2) throw std::runtime_error("log and truth share no stamps");
  // A map may lie anywhere: it is laid on the truth by the rigid motion that leaves the least squares, without a scale.
  const auto count = static_cast<double>(pairs.size());
  Eigen::Vector2d middle{0, 0}, true_middle{0, 0};
  for (const auto& [mine, real] : pairs) {
    middle += mine / count;
    true_middle += real / count;
  }
  double along = 0.0, across = 0.0;
  for (const auto& [mine, real] : pairs) {
    const Eigen::Vector2d a = mine - middle, b = real - true_middle;
    along += a.dot(b);
    across += a.x() * b.y() - a.y() * b.x();
  }
  const Pose2 turn{0.0, 0.0, std::atan2(across, along)};
  double squares = 0.0;
  for (const auto& [mine, real] : pairs) squares += (turn * (mine - middle) - (real - true_middle)).squaredNorm();
  const double rmse = std::sqrt(squares / count);
  std::printf("%zu of %zu scans; verdict %s; off by %.4f m (RMSE)\n", pairs.size(), result.scans.size(),
              to_string(result.verdict.verdict), rmse);
  return rmse < 0.1 ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
