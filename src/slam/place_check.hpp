/// When a match of two scans says that they were taken at the same place.
#pragma once

#include "phasescan/match/result.hpp"

namespace phasescan {

/// Share of the hits that may lie where the other scan looked through.
inline constexpr double kMostViolation = 0.04;

/// Stricter than `usable`, which is made for two scans that have something to do with each other: of many places one
/// looks alike by chance, with walls that fit and a confidence near 1. What it cannot hide are hits where the other
/// scan looked through: in flats 98 % of the right answers have fewer than 3 % of them, 98 % of the wrong more than 6
/// %.
inline bool is_same_place(const MatchResult& match) {
  return match.usable && match.diagnostics.violation <= kMostViolation;
}

}  // namespace phasescan
