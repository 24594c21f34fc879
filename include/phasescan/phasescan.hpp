/// Every public header of the components that are installed.
#pragma once

#include "phasescan/match/scan_matcher.hpp"  // IWYU pragma: export

#if __has_include("phasescan/fft_icp/fft_icp.hpp")
#include "phasescan/fft_icp/fft_icp.hpp"  // IWYU pragma: export
#endif
#if __has_include("phasescan/slam/slam.hpp")
#include "phasescan/odometry/odometry.hpp"  // IWYU pragma: export
#include "phasescan/slam/slam.hpp"          // IWYU pragma: export
#include "phasescan/slam/state.hpp"         // IWYU pragma: export
#endif
#if __has_include("phasescan/localize/localizer.hpp")
#include "phasescan/localize/localizer.hpp"  // IWYU pragma: export
#endif
#if __has_include("phasescan/io/log.hpp")
#include "phasescan/io/log.hpp"  // IWYU pragma: export
#endif
#if __has_include("phasescan/live/turns.hpp")
#include "phasescan/live/decoder.hpp"  // IWYU pragma: export
#include "phasescan/live/live.hpp"     // IWYU pragma: export
#include "phasescan/live/turns.hpp"    // IWYU pragma: export
#endif
