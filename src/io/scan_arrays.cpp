#include <algorithm>
#include <charconv>
#include <cmath>

#include "io/json.hpp"
#include "io/number.hpp"
#include "phasescan/io/scan_json.hpp"

namespace phasescan::json {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// A walk over the text; every step may fail, which sends the caller to the slow way.
class Cursor {
 public:
  explicit Cursor(std::string_view text) : at_(text.data()), end_(text.data() + text.size()) {}

  bool done() const { return at_ == end_; }
  char peek() const { return at_ == end_ ? '\0' : *at_; }
  const char* position() const { return at_; }
  void skip() { ++at_; }
  void skip_blanks() {
    while (at_ != end_ && (*at_ == ' ' || *at_ == '\t' || *at_ == '\n' || *at_ == '\r')) ++at_;
  }
  bool take(char c) {
    skip_blanks();
    if (peek() != c) return false;
    ++at_;
    return true;
  }
  /// A string without escapes, the opening quote taken already.
  bool take_string(std::string_view& out) {
    const char* begin = at_;
    while (at_ != end_ && *at_ != '"' && *at_ != '\\') ++at_;
    if (peek() != '"') return false;
    out = {begin, static_cast<std::size_t>(at_ - begin)};
    ++at_;
    return true;
  }
  /// A number as JSON writes it, or null.
  bool take_number(double& value) {
    if (std::string_view(at_, static_cast<std::size_t>(end_ - at_)).starts_with("null")) {
      at_ += 4;
      value = std::nan("");
      return true;
    }
    const char* digit = at_ + (peek() == '-' ? 1 : 0);
    if (digit >= end_ || !is_digit(*digit)) return false;
    if (*digit == '0' && digit + 1 != end_ && is_digit(digit[1])) return false;
    if (const char* const plain = read_plain_decimal(at_, end_, value)) {
      at_ = plain;
      return true;
    }
    const auto [end, error] = std::from_chars(at_, end_, value);
    if (error != std::errc{} || end[-1] == '.') return false;
    at_ = end;
    return true;
  }
  bool take_numbers(std::vector<float>& out) {
    if (take(']')) return true;
    do {
      skip_blanks();
      double value = 0.0;
      if (out.size() >= kMaxBeams || !take_number(value)) return false;
      out.push_back(bounded(value));
      skip_blanks();
      if (peek() == ',') {
        skip();
        continue;
      }
      return take(']');
    } while (true);
  }

 private:
  const char* at_;
  const char* end_;
};

}  // namespace

bool take_scan_arrays(std::string_view text, ScanArrays& arrays, std::string& rest) {
  Cursor cursor(text);
  rest.clear();
  const char* copied = text.data();
  int depth = 0;
  while (!cursor.done()) {
    const char c = cursor.peek();
    cursor.skip();
    if (c == '{' || c == '[') ++depth;
    if (c == '}' || c == ']') --depth;
    if (c != '"') continue;
    std::string_view word;
    if (!cursor.take_string(word)) return false;
    if (depth != 1) continue;
    std::optional<std::vector<float>>* array = word == "ranges"        ? &arrays.ranges
                                               : word == "intensities" ? &arrays.intensities
                                               : word == "angles"      ? &arrays.angles
                                                                       : nullptr;
    if (array == nullptr || !cursor.take(':') || !cursor.take('[')) continue;
    if (*array) return false;  // the same key twice
    rest.append(copied, cursor.position());
    array->emplace().reserve(arrays.ranges ? arrays.ranges->size() : 0);
    if (!cursor.take_numbers(**array)) return false;
    rest += ']';
    copied = cursor.position();
  }
  rest.append(copied, text.data() + text.size());
  return arrays.ranges.has_value();
}

}  // namespace phasescan::json
