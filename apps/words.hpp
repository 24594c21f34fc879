// Values of flags that are words: refused with the nearest one named, and offered by the shell's completion.
#pragma once

#include <CLI/CLI.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace phasescan::app {

/// One of these words and nothing else.
CLI::Validator one_of(std::vector<std::string> words);
/// Anything; these are what the completion offers.
CLI::Validator offers(std::vector<std::string> words);
CLI::Validator offers(std::span<const std::string_view> words);

/// The words of `one_of` or `offers` of an option, none where it has neither.
std::vector<std::string> words_of(CLI::Option& option);

/// Every flag of a command as it is typed ("--out"), and its sub-commands' names.
std::vector<std::string> flags_of(const CLI::App& command);
std::vector<std::string> commands_of(const CLI::App& command);

}  // namespace phasescan::app
