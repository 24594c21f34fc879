#include "io/tum.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "phasescan/io/error.hpp"
#include "io/file.hpp"

namespace phasescan {
namespace {

/// Splits off the next number of a line. False at its end or at something that is no finite number.
bool next_number(const char*& at, const char* end, double& value) {
  while (at < end && (*at == ' ' || *at == '\t' || *at == '\r')) ++at;
  const auto [rest, error] = std::from_chars(at, end, value);
  if (error != std::errc() || (rest < end && *rest != ' ' && *rest != '\t' && *rest != '\r')) return false;
  at = rest;
  return std::isfinite(value);
}

/// Seconds with decimals to nanoseconds without the rounding of a double: large epochs keep all their digits.
Stamp parse_stamp(const char* at, const char* end, double fallback) {
  while (at < end && (*at == ' ' || *at == '\t')) ++at;
  Stamp seconds = 0, fraction = 0;
  const bool negative = at < end && *at == '-';
  if (negative) ++at;
  auto [rest, error] = std::from_chars(at, end, seconds);
  if (error != std::errc() || !(std::abs(fallback) < kMostStampSeconds)) return stamp_from_seconds(fallback);
  if (rest < end && (*rest == 'e' || *rest == 'E')) return stamp_from_seconds(fallback);
  if (rest < end && *rest == '.') {
    ++rest;
    int digits = 0;
    for (; rest < end && *rest >= '0' && *rest <= '9'; ++rest) {
      if (digits < 9) fraction = fraction * 10 + (*rest - '0'), ++digits;
    }
    for (; digits < 9; ++digits) fraction *= 10;
    if (rest < end && (*rest == 'e' || *rest == 'E')) return stamp_from_seconds(fallback);
  }
  const Stamp stamp = seconds * 1'000'000'000 + fraction;
  return negative ? -stamp : stamp;
}

}  // namespace

std::string format_tum(std::span<const StampedPose> poses) {
  std::string text;
  text.reserve(poses.size() * 80);
  for (const StampedPose& p : poses) {
    const Stamp whole = p.stamp / 1'000'000'000, rest = p.stamp % 1'000'000'000;
    fmt::format_to(std::back_inserter(text), "{}{}.{:09d} {:.6f} {:.6f} 0 0 0 {:.9f} {:.9f}\n", p.stamp < 0 ? "-" : "",
                   std::abs(whole), std::abs(rest), p.pose.x, p.pose.y, std::sin(0.5 * p.pose.theta),
                   std::cos(0.5 * p.pose.theta));
  }
  return text;
}

std::vector<StampedPose> read_tum(const std::string& path) {
  LineReader lines(path);
  std::vector<StampedPose> poses;
  std::string line;
  while (lines.next(line)) {
    const long number = lines.line_number();
    const char* at = line.data();
    const char* const end = at + line.size();
    const auto first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') continue;
    double v[8];
    for (double& value : v) {
      if (!next_number(at, end, value)) throw InputError(path, number, "expected 8 numbers: stamp x y z qx qy qz qw");
    }
    if (double extra = 0.0; next_number(at, end, extra))
      throw InputError(path, number, "more than 8 numbers: expected stamp x y z qx qy qz qw");
    const double yaw = std::atan2(2.0 * (v[7] * v[6] + v[4] * v[5]), 1.0 - 2.0 * (v[5] * v[5] + v[6] * v[6]));
    poses.push_back({parse_stamp(line.data(), end, v[0]), {v[1], v[2], wrap_angle(yaw)}});
  }
  return poses;
}

}  // namespace phasescan
