/// What a standstill looks like before any model is fitted: the table by which simulated and recorded sensors compare.
#pragma once

#include <span>
#include <vector>

#include "calibrate/beams.hpp"

namespace phasescan {

/// Spread of the ranges of beams on smooth surface that answer in more than 80 % of a stop's scans.
struct StandstillRow {
  double from = 0.0, to = 0.0;  ///< range [m]
  std::size_t beams = 0;
  double median = 0.0;  ///< standard deviation over a stop, its median over beams [m]
  double most = 0.0;    ///< and its 90th percentile
  double steep = 0.0;   ///< median where the range changes by more than 2 cm from beam to beam; NaN without such beams
};

struct StandstillTable {
  std::vector<StandstillRow> rows;  ///< ranges with 20 beams and more
  double turn_steps = 0.0;          ///< turn of whole revolutions, standard deviation [beam steps]
  std::size_t turns = 0;
  double present = 0.0;      ///< mean share of the scans in which beams answer that ever do (in more than 5 %)
  double come_and_go = 0.0;  ///< share of these beams that answer in 5-95 %
};

StandstillTable standstill_table(std::span<const StopBeams> stops);

}  // namespace phasescan
