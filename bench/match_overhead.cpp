// The C++ side of bench/python/match_overhead.py: CPU ms a match, and a match of match_many, of the scans in a file.
#include <cstdio>
#include <fstream>
#include <phasescan/core/time.hpp>
#include <phasescan/match/scan_matcher.hpp>
#include <vector>

using namespace phasescan;

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  std::ifstream file(argv[1], std::ios::binary);
  double head[6] = {};
  file.read(reinterpret_cast<char*>(head), sizeof(head));
  const auto count = static_cast<std::size_t>(head[0]), beams = static_cast<std::size_t>(head[1]);
  const ScanGeometry geometry{head[2], head[3], head[4], head[5]};
  std::vector<std::vector<float>> ranges(count, std::vector<float>(beams));
  for (auto& scan : ranges)
    file.read(reinterpret_cast<char*>(scan.data()), static_cast<std::streamsize>(beams * sizeof(float)));
  if (!file) return 2;
  // One matcher for all, as a program has that matches again and again. The last of some rounds counts: Python matches
  // in one process, too.
  ScanMatcher matcher;
  double one = 0.0, many = 0.0, sum = 0.0;
  for (int round = 0; round < 3; ++round) {
    double begin = process_cpu_seconds();
    for (const auto& scan : ranges)
      sum += matcher.match(make_scan(ranges[0], geometry), make_scan(scan, geometry)).T_ref_scan.x;
    one = process_cpu_seconds() - begin;
    begin = process_cpu_seconds();
    std::vector<Scan> scans;
    for (const auto& scan : ranges) scans.push_back(make_scan(scan, geometry));
    for (const MatchResult& result : match_many(make_scan(ranges[0], geometry), scans)) sum += result.T_ref_scan.x;
    many = process_cpu_seconds() - begin;
  }
  std::printf("%.6f %.6f\n", 1e3 * one / static_cast<double>(count), 1e3 * many / static_cast<double>(count));
  return sum == 12345.678 ? 1 : 0;
}
