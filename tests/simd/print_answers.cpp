// Prints the answers of the kernels: integers as one hash, then a pose a line. scripts/neon compares two such lists.
#include <cstdio>

#include "simd/answers.hpp"

int main() {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const std::uint32_t value : phasescan::test::integer_answers()) hash = (hash ^ value) * 1099511628211ULL;
  std::printf("integers %016llx\n", static_cast<unsigned long long>(hash));
  for (const phasescan::MatchResult& r : phasescan::test::match_answers())
    std::printf("%.9f %.9f %.9f %d\n", r.T_ref_scan.x, r.T_ref_scan.y, r.T_ref_scan.theta, r.usable);
}
