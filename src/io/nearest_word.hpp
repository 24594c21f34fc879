/// Which of the words that are known somebody may have meant.
#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "phasescan/core/options.hpp"

namespace phasescan {

/// Letters added, left out, replaced or swapped with their neighbour between two words, capitals as small letters.
std::size_t word_distance(std::string_view a, std::string_view b);

/// "; did you mean 'x'?" with the word nearest to `word`: one letter off, or a third of its letters, or begun by it.
/// Empty where none is near, and for a word that is one of them.
std::string did_you_mean(std::string_view word, std::span<const std::string> words);
std::string did_you_mean(std::string_view word, std::span<const std::string_view> words);

/// The value of an enum by its name. @throws std::invalid_argument naming the choices and the nearest one.
template <class E>
E enum_from_word(const std::string& word) {
  try {
    return enum_from_string<E>(word);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(error.what() + did_you_mean(word, enum_names<E>()));
  }
}

}  // namespace phasescan
