// What `phasescan bench localize` writes of scans and of its confidence.
#pragma once

#include <string>
#include <vector>

#include "eval/localize_bench.hpp"
#include "eval/localize_places.hpp"
#include "eval/localize_runs.hpp"

namespace phasescan::app {

/// A line of JSON per case: what the confidence is fitted on.
std::string case_lines(const std::vector<LocalizeCase>& cases, const std::vector<LocalizeRow>& rows);

/// A line of JSON for a scan of a drive.
std::string scan_line(const DrivenScan& scan);

/// Mean confidence, share right and number by tenths of the confidence: the part ", \"reliability\": [...]" of a line.
std::string reliability_part(const std::vector<ReliabilityBin>& bins);

/// The same as an SVG, with the number of answers that were not ambiguous and their calibration error in the legend.
std::string reliability_figure(const std::vector<ReliabilityBin>& bins, double calibration_error);

/// JSON has no word for the median of nothing.
std::string number_or_null(double value, int digits);

}  // namespace phasescan::app
