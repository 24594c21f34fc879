/// A log cut down to what was asked for: a part of its time, of its ranges, of its directions.
#pragma once

#include <memory>

#include "phasescan/io/log.hpp"

namespace phasescan {

/// Whether the options cut anything.
bool cuts_anything(const LogOptions& options);

/// The log behind the cuts of `options`: range_min, range_max, masks, from, to.
std::unique_ptr<LogReader> cut_log(std::unique_ptr<LogReader> log, const LogOptions& options);

/// A scan with hits nearer than `range_min` too near, those farther than `range_max` (0: none) out of range, and what
/// lies in a mask invalid. Its stated limits become the tighter ones.
Scan cut_scan(const Scan& scan, const LogOptions& options);

}  // namespace phasescan
