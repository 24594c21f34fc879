/// Three text formats that low-cost scanners were logged in, one scan a line, with wheel odometry.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "io/log_input.hpp"
#include "phasescan/io/log.hpp"

namespace phasescan {

enum class LowcostFormat {
  kSlambot,  ///< RPLidar A1 on a tracked robot: `left right ms r0 .. r359`, ticks, mm, clockwise
  kBreezy,   ///< Hokuyo URG-04LX: 24 numbers of the robot, 682 ranges in mm, one number more
  kPolar,    ///< YDLidar X4: `distance, turn, seconds, r0, ..`, mm, degrees, m; the number of ranges varies
};

/// By the first 20 lines: how many numbers they have, which of them are integers, ranges and a clock that runs.
std::optional<LowcostFormat> sniff_lowcost(std::string_view beginning);

std::unique_ptr<LogReader> open_lowcost(LogInput& input, LowcostFormat format);

}  // namespace phasescan
