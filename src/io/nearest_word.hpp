/// Which of the words that are known somebody may have meant.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace phasescan {

/// Letters added, left out, replaced or swapped with their neighbour between two words, capitals as small letters.
std::size_t word_distance(std::string_view a, std::string_view b);

/// "; did you mean 'x'?" with the word nearest to `word`: one letter off, or a third of its letters, or begun by it.
/// Empty where none is near, and for a word that is one of them.
std::string did_you_mean(std::string_view word, std::span<const std::string> words);
std::string did_you_mean(std::string_view word, std::span<const std::string_view> words);

}  // namespace phasescan
