/// The experiments of [Jiang19] Sec. 5, repeated on simulated RPLidar A1 data: the method as printed and with this
/// project's defaults side by side.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace phasescan {

/// What to run.
struct PaperOptions {
  bool quick = false;  ///< an eighth of the pairs, fewer speeds: under a minute on 2 cores
  std::uint64_t seed = 2019;
  std::vector<std::string> pairs;  ///< pairs files on which Fig. 10 and Table 2 are repeated
  int threads = 1;
  bool times =
      true;  ///< false: Tables 3 and 4 are left out and the output is the same, byte for byte, for any thread count
  std::string version;
};

/// File name below the output folder -> content: report.html, figures/*.svg, data/*.json.
using PaperFiles = std::map<std::string, std::string>;

/// Runs everything. Names of the parts go to `progress` as they begin.
/// @throws InputError for a pairs file that cannot be used.
/// @cost about 4 CPU minutes, half a minute with `quick`
PaperFiles run_paper(const PaperOptions& options, const std::function<void(std::string_view part)>& progress = {});

}  // namespace phasescan
