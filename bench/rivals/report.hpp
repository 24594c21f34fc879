/// The comparison as Markdown and JSON.
#pragma once

#include <string>
#include <vector>

#include "contender.hpp"
#include "eval/pair_outcome.hpp"

namespace phasescan::rivals {

struct ReportInfo {
  std::string version;
  std::string note;                  ///< date and machine, as the caller knows them
  std::vector<std::string> sources;  ///< files or simulated sets
  std::size_t pairs = 0;
  std::size_t without_truth = 0;  ///< pairs that were left out for it
  int repeat = 1;
  double fft_ms = 0.0;  ///< one 128 x 128 real-to-complex float FFT in this process
};

/// A table per dataset (contender x class), one of all datasets, the duels, and what each contender is.
std::string markdown(const std::vector<PairOutcome>& outcomes, const std::vector<Contender>& contenders,
                     const ReportInfo& info);

/// The same, machine-readable: `rows` per dataset x class x contender, `duels`, `contenders`.
std::string json(const std::vector<PairOutcome>& outcomes, const std::vector<Contender>& contenders,
                 const ReportInfo& info);

}  // namespace phasescan::rivals
