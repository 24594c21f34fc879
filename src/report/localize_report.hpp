/// The report of a run of localisation: the map with the way on it, and how sure the poses were over time.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "phasescan/localize/localizer.hpp"

namespace phasescan {

struct LocalizeReport {
  std::string log_name;
  const TrinaryMap* map = nullptr;
  const std::vector<LocalizationUpdate>* updates = nullptr;
  bool each = false;  ///< every scan by itself: no way is drawn
  double min_confidence = 0.95;
  std::string verdict;
  std::vector<std::string> reasons;
  std::vector<std::pair<std::string, std::string>> facts;
  std::vector<std::string> warnings;
  std::vector<std::pair<std::string, std::string>> times;  ///< empty: no section on time
};

/// @pre map and updates are set
std::string format_localize_report(const LocalizeReport& report);

}  // namespace phasescan
