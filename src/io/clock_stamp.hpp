/// Times as clocks and calendars write them.
#pragma once

#include <optional>
#include <string_view>

#include "phasescan/core/time.hpp"

namespace phasescan {

/// "13:12:54.032452" (since midnight), "2023-05-01T13:12:54.5Z", "2023-05-01 13:12:54+02:00", "1970/01/01/02:03:26.98":
/// up to nine decimals, exact; without a zone it is UTC. Nothing for text that is no such time.
std::optional<Stamp> parse_clock_stamp(std::string_view text);

/// Times of day become one running time: one that lies more than half a day before the one before is of the next day.
class ClockDays {
 public:
  Stamp unrolled(Stamp time_of_day);

 private:
  std::optional<Stamp> before_;
  Stamp days_ = 0;
};

}  // namespace phasescan
