/// Files that are not for us: what they are, and what makes a log of them.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace phasescan {

/// By a file's first bytes: "is a Git LFS pointer, ...; expected ...".
std::optional<std::string> foreign_file(std::string_view prefix);

/// For lines of nothing but numbers: how many there are, and what to type to have them read.
std::optional<std::string> numbers_hint(std::string_view prefix);

}  // namespace phasescan
