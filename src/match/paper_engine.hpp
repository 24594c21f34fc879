/// The five methods of [Jiang19] Sec. 5.
#pragma once

#include "match/engine.hpp"

namespace phasescan {

/// Engine for icp, ndt, fft, fft-icp1 and fft-icp2.
std::unique_ptr<MatchEngine> make_paper_engine(const MatchOptions& options);

}  // namespace phasescan
