#include "run.hpp"

#include <algorithm>
#include <exception>
#include <limits>

#include "phasescan/core/time.hpp"

namespace phasescan::rivals {

std::vector<PairOutcome> run(const std::vector<ScanPair>& pairs, const std::vector<Contender>& contenders,
                             const RunSettings& settings) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<PairOutcome> outcomes;
  for (std::size_t m = 0; m < contenders.size(); ++m) {
    std::size_t threw = 0;
    for (const ScanPair& pair : pairs) {
      MatchResult result;
      double seconds = std::numeric_limits<double>::infinity();
      try {
        for (int r = 0; r < std::max(1, settings.repeat); ++r) {
          const double start = process_cpu_seconds();
          result.T_ref_scan = contenders[m].match(pair.reference, pair.scan);
          seconds = std::min(seconds, process_cpu_seconds() - start);
        }
        result.usable = true;
        result.ms.total = 1e3 * seconds;
      } catch (const std::exception&) {
        ++threw;
        result.T_ref_scan = {kNone, kNone, kNone};
        result.ms.total = kNone;
      }
      outcomes.push_back(judge(pair, result, m, kNone));
    }
    if (settings.done) settings.done(contenders[m].name, threw);
  }
  return outcomes;
}

}  // namespace phasescan::rivals
