/// Confidence against the share of right answers, as a chart.
#pragma once

#include <span>
#include <string>

#include "eval/statistics.hpp"
#include "report/chart.hpp"

namespace phasescan {

/// The axes and the diagonal on which a calibrated confidence lies; no answers yet.
Chart reliability_axes(const std::string& title);

/// A point per tenth of the confidence that has answers, with its 95 % Wilson interval. Name and looks are the
/// caller's.
Series reliability_points(std::span<const ReliabilityBin> bins);

}  // namespace phasescan
