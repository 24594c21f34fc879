/// What files of prepared maps begin with.
#pragma once

#include "state/container.hpp"

namespace phasescan {

/// To be raised with every change of what a map is prepared to, or of how a saved run is drawn: files of any other
/// version are not read. The test PreparedMap.ItsVersionGoesWithWhatIsPrepared notices the first.
inline constexpr std::uint32_t kPreparedVersion = 1;
inline constexpr StateFileKind kPreparedMap{std::string_view("\x89PSREADY", 8), kPreparedVersion, kPreparedVersion,
                                            "prepared map", "a file written by --keep-prepared or save_prepared"};

}  // namespace phasescan
