// A reader for a format of one's own, and its scans in the matcher. The format here: a line a scan, "SECONDS: r r r
// ...", ranges in centimetres, one degree apart, clockwise from ahead.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <phasescan/io/log.hpp>
#include <phasescan/match/scan_matcher.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace {

class CentimetreReader : public phasescan::LogReader {
 public:
  explicit CentimetreReader(const std::string& path) : path_(path), file_(path) {}

  std::optional<phasescan::LogEntry> next() override {
    for (std::string line; std::getline(file_, line);) {
      ++line_;
      std::istringstream words(line);
      double seconds = 0.0;
      char colon = 0;
      if (!(words >> seconds >> colon) || colon != ':') {
        add_damage("bad line", path_ + ":" + std::to_string(line_) + ": no time; expected SECONDS: and ranges");
        continue;  // a bad line is counted, the others are read
      }
      std::vector<float> ranges;
      for (float centimetres = 0; words >> centimetres;) ranges.push_back(0.01F * centimetres);
      phasescan::LogEntry entry;
      entry.scan = phasescan::make_scan(ranges, {0.0, -phasescan::deg_to_rad(1), 0.1, 10.0});
      entry.scan.stamp = phasescan::stamp_from_seconds(seconds);
      entry.laser = "my laser";
      entry.line = line_;
      return entry;
    }
    return std::nullopt;
  }
  std::string format() const override { return "centimetres"; }

 private:
  std::string path_;
  std::ifstream file_;
  long line_ = 0;
};

// Two scans of a room of 6 m x 4 m, the second one 0.2 m ahead and turned left by 30 degrees, and a bad line.
void make_log(const std::string& path) {
  std::ofstream file(path);
  for (const double turn : {0.0, phasescan::deg_to_rad(30)}) {
    file << (turn > 0.0 ? "no scan\n1.5:" : "1.0:");
    const double x = turn > 0.0 ? 0.2 : 0.0;
    for (int beam = 0; beam < 360; ++beam) {
      const double angle = turn - phasescan::deg_to_rad(beam), dx = std::cos(angle), dy = std::sin(angle);
      double to_x = ((dx > 0 ? 4.0 : -2.0) - x) / dx;
      if (dx > 0 && to_x * dy > 1.0)
        to_x = (5.0 - x) / dx;  // an alcove, which tells one end of the room from the other
      file << ' ' << 100.0 * std::min(to_x, std::abs((dy > 0 ? 2.5 : -1.5) / dy));
    }
    file << '\n';
  }
}

}  // namespace

int main() {
  make_log("example_06.txt");
  CentimetreReader reader("example_06.txt");
  std::vector<phasescan::RangeMeasurement> scans;
  while (auto entry = reader.next()) scans.push_back(phasescan::to_measurement(std::move(*entry)));
  const phasescan::MatchResult result = phasescan::match_scans(scans.at(0).scan, scans.at(1).scan);
  std::printf("%zu scans, %zu bad lines; x %.3f m, turned %.1f deg, usable: %s\n", scans.size(), reader.damage_count(),
              result.T_ref_scan.x, phasescan::rad_to_deg(result.T_ref_scan.theta), result.usable ? "yes" : "no");
  const bool right = std::abs(result.T_ref_scan.x - 0.2) < 0.02 &&
                     phasescan::angle_distance(result.T_ref_scan.theta, phasescan::deg_to_rad(30)) < 0.01;
  return right && result.usable ? 0 : 1;
}
