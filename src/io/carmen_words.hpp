// Words of a line of a CARMEN log, and what can be wrong with them.
#pragma once

#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "io/file.hpp"
#include "io/number.hpp"
#include "phasescan/io/scan_json.hpp"

namespace phasescan {

// What is wrong with a line, for `damage_here`.
struct BadLine {
  const char* kind;
  std::string reason;
};

// The words of a line, taken one by one.
class Words {
 public:
  explicit Words(std::string_view line) {
    const auto blank = [](char c) { return c == ' ' || c == '\t'; };
    const char* at = line.data();
    const char* const end = at + line.size();
    words_.reserve(line.size() / 5);
    for (;;) {
      while (at != end && blank(*at)) ++at;
      if (at == end) return;
      const char* const begin = at;
      while (at != end && !blank(*at)) ++at;
      words_.emplace_back(begin, static_cast<std::size_t>(at - begin));
    }
  }

  std::size_t left() const { return words_.size() - next_; }
  std::string_view word() {
    if (left() == 0) throw BadLine{"truncated line", "the line ends too early; expected more fields"};
    return words_[next_++];
  }
  double number(const char* what) {
    const std::string_view text = word();
    const auto value = parse_number<double>(text);
    if (!value) throw BadLine{"non-number", std::string(what) + " is " + quote_text(text) + "; expected a number"};
    return *value;
  }
  double finite(const char* what, double limit) {
    const double value = number(what);
    if (!(std::abs(value) <= limit))
      throw BadLine{"bad value", std::string(what) + " is not a possible value; expected a finite number"};
    return value;
  }
  std::size_t count(const char* what) {
    const std::string_view text = word();
    const auto value = parse_number<long>(text);
    if (!value || *value < 0)
      throw BadLine{"wrong count", std::string(what) + " is " + quote_text(text) + "; expected a count"};
    if (*value > static_cast<long>(kMaxBeams)) {
      throw BadLine{"wrong count",
                    std::string(what) + " is " + std::string(text) + "; expected at most " + std::to_string(kMaxBeams)};
    }
    return static_cast<std::size_t>(*value);
  }
  Pose2 pose(const char* what) {
    const double x = finite(what, 1e9), y = finite(what, 1e9);
    return {x, y, wrap_angle(finite(what, 1e9))};
  }
  std::string_view peek(std::size_t ahead) const { return words_[next_ + ahead]; }
  void expect_left(std::size_t expected, std::size_t beams) const {
    if (left() == expected) return;
    throw BadLine{"wrong count", std::to_string(left()) + " fields after the count " + std::to_string(beams) +
                                     "; expected " + std::to_string(expected)};
  }

 private:
  std::vector<std::string_view> words_;
  std::size_t next_ = 0;
};

}  // namespace phasescan
