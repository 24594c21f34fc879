// Files that a flag may not name: a log would be destroyed, or a result would be written twice.
#pragma once

#include <string>
#include <vector>

namespace phasescan::app {

/// @param file  what `flag` names; empty: nothing  @param out  the folder of the results
/// @throws std::invalid_argument
void refuse_in_the_way(const std::string& flag, const std::string& file, const std::vector<std::string>& logs,
                       const std::string& out);

}  // namespace phasescan::app
