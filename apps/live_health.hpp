// Whether a run of `live` is well, asked over its port.
#pragma once

#include <string>

namespace phasescan::app {

/// Asks http://ADDR:PORT/api/status and prints a line. Gives kDone where it tracks, kAnswerIsNo where it is lost or no
/// scan comes. @throws SystemError where nobody answers, std::invalid_argument for an address that is none
int run_health(const std::string& url);

}  // namespace phasescan::app
