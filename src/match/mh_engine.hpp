/// This project's own method, fft-mh.
#pragma once

#include "match/engine.hpp"

namespace phasescan {

std::unique_ptr<MatchEngine> make_mh_engine(const MatchOptions& options);

}  // namespace phasescan
