// Reads a log of any format: its scans with odometry, what was assumed, what was damaged. Writes it in another format.
// Usage: 05_read_a_log [LOG]   ("-" is standard input; without LOG a small one is made first)
#include <cstdio>
#include <phasescan/io/error.hpp>
#include <phasescan/io/log.hpp>
#include <string>
#include <vector>

namespace {

// A robot that drives 2 m along a wall, as a CARMEN log.
void make_log(const std::string& path) {
  const auto writer = phasescan::make_log_writer(phasescan::log_target_for(path), path);
  for (int k = 0; k < 20; ++k) {
    phasescan::LogEntry entry;
    entry.scan = phasescan::make_scan(std::vector<float>(181, 1.5F), {-1.5, 3.0 / 180, 0.1, 8.0});
    entry.scan.stamp = phasescan::stamp_from_seconds(1.7e9 + 0.1 * k);
    entry.odometry = phasescan::Pose2{0.1 * k, 0.0, 0.0};
    entry.laser = "/scan";
    writer->add(entry);
  }
  writer->finish();
}

}  // namespace

int main(int argc, char** argv) {
  const std::string path = argc > 1 ? argv[1] : "example_05.log";
  try {
    if (argc < 2) make_log(path);
    const auto log = phasescan::open_log(path);
    const auto copy = phasescan::make_log_writer(phasescan::LogTarget::kScanLog, "example_05.jsonl.gz");
    std::size_t scans = 0, hits = 0;
    while (const auto entry = log->next()) {
      // What a log says becomes what tracking takes: upright scans, poses at the scan's stamp.
      const phasescan::RangeMeasurement measurement = phasescan::to_measurement(*entry);
      ++scans;
      hits += measurement.scan.hit_count();
      copy->add(*entry);
    }
    copy->finish();
    std::printf("%s: %s, %zu scans, %zu hits\n", path.c_str(), log->format().c_str(), scans, hits);
    for (const auto& remark : log->remarks()) std::printf("assumed: %s\n", remark.text.c_str());
    for (const auto& damage : log->damages()) std::printf("damaged: %s\n", damage.text.c_str());
    return scans > 0 ? 0 : 1;
  } catch (const phasescan::InputError& error) {  // no such file, no known format
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
