#include "io/nearest_word.hpp"

#include <algorithm>

namespace phasescan {
namespace {

constexpr std::size_t kLongestWord = 40;       // of what is compared: longer ones are no slips
constexpr std::size_t kShortestBeginning = 3;  // of a word that is taken for the beginning of another

char small(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

}  // namespace

std::size_t word_distance(std::string_view a, std::string_view b) {
  // Optimal string alignment, three rows of the table at a time.
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before.swap(last);
    last.swap(row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = small(a[i - 1]) == small(b[j - 1]);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (same ? 0 : 1)});
      const bool swapped = i > 1 && j > 1 && small(a[i - 1]) == small(b[j - 2]) && small(a[i - 2]) == small(b[j - 1]);
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row[b.size()];
}

std::string did_you_mean(std::string_view word, std::span<const std::string_view> words) {
  if (word.empty() || word.size() > kLongestWord) return "";
  std::string_view best;
  std::size_t least = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const std::string_view other : words) {
    const std::size_t distance = word_distance(word, other);
    if (word == other) return "";
    if (distance < least && distance < word.size()) least = distance, best = other;
  }
  for (const std::string_view other : words) {
    if (best.empty() && word.size() >= kShortestBeginning && other.starts_with(word)) best = other;
  }
  return best.empty() ? "" : "; did you mean '" + std::string(best) + "'?";
}

std::string did_you_mean(std::string_view word, std::span<const std::string> words) {
  const std::vector<std::string_view> views(words.begin(), words.end());
  return did_you_mean(word, std::span<const std::string_view>(views));
}

}  // namespace phasescan
