/// Tables 2, 3 and 4 of [Jiang19]: the paper's own numbers beside both variants of this project.
#pragma once

#include <array>
#include <vector>

#include "eval/paper_kit.hpp"
#include "eval/pair_outcome.hpp"
#include "report/table.hpp"

namespace phasescan {

inline constexpr std::array<Variant, 2> kBoth{Variant::kPrinted, Variant::kOurs};

/// All methods of both variants in one run, so that they see the same pairs and the same state of the machine.
struct Columns {
  std::vector<BenchMethod> methods;
  std::vector<std::size_t> of(Variant variant) const {
    std::vector<std::size_t> out;
    for (std::size_t m = 0; m < methods.size(); ++m) {
      if ((m < printed) == (variant == Variant::kPrinted)) out.push_back(m);
    }
    return out;
  }
  std::size_t printed = 0;
};

/// Errors over the successes of the three classes of the paper.
Table accuracy_table2(const std::vector<PairOutcome>& outcomes, const Columns& columns);
/// Mean time of each step of fft-icp2.
Table step_time_table3(const std::vector<PairOutcome>& outcomes, const Columns& columns);
/// Mean time of each method by scene.
Table scene_time_table4(const std::vector<PairOutcome>& outcomes, const Columns& columns);
/// How often fft-icp2 takes the missing-data shortcut, and what comes of it.
Table shortcut_table(const std::vector<PairOutcome>& outcomes, const Columns& columns);

}  // namespace phasescan
