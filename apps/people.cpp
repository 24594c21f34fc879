#include "people.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "commands.hpp"
#include "phasescan/core/pose2.hpp"

namespace phasescan::app {
namespace {

/// Decimals of a number with this standard deviation: down to its first digit, within `least` and `most`.
int decimals_of(double sigma, int least, int most) {
  if (!(sigma > 0.0) || !std::isfinite(sigma)) return most;
  return std::clamp(static_cast<int>(std::ceil(1.0 - std::log10(sigma))) - 1, least, most);
}

/// A standard deviation in the unit that suits it; "unknown" where the covariance is capped.
std::string sigma_text(double metres) {
  constexpr double kUnknown = 100.0;  // [m] wider than any room: nothing is known
  if (!(metres < kUnknown)) return "unknown along a direction";
  return metres < 0.1 ? fmt::format("{:.1f} cm", std::max(0.1, 100.0 * metres)) : fmt::format("{:.1f} m", metres);
}

}  // namespace

bool for_people() {
  return ::isatty(STDOUT_FILENO) == 1;
}

bool has_colors(int descriptor) {
  const char* off = std::getenv("NO_COLOR");
  const char* terminal = std::getenv("TERM");
  return ::isatty(descriptor) == 1 && (off == nullptr || *off == '\0') && terminal != nullptr &&
         std::string_view(terminal) != "dumb" && *terminal != '\0';
}

std::string toned(std::string_view text, Tone tone) {
  if (tone == Tone::kPlain || !has_colors(STDOUT_FILENO)) return std::string(text);
  const char* code = tone == Tone::kGood ? "32" : tone == Tone::kBad ? "31" : "2";
  return fmt::format("\033[{}m{}\033[0m", code, text);
}

void print_ending(const std::vector<EndingLine>& lines) {
  if (!for_people()) return;
  std::size_t width = 0;
  for (const auto& [name, value] : lines) width = std::max(width, name.size());
  for (const auto& [name, value] : lines)
    print(toned(fmt::format("{:<{}}", name, width), Tone::kFaint) + "  " + value + "\n");
}

std::string metres_text(double metres) {
  const double size = std::abs(metres);
  return fmt::format("{:.{}f} m", metres, size < 9.995 ? 2 : size < 99.95 ? 1 : 0);
}

std::string count_text(std::size_t count, std::string_view what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

std::string match_text(const MatchResult& result) {
  const auto& c = result.covariance;
  const double mean = 0.5 * (c(0, 0) + c(1, 1)), off = std::hypot(0.5 * (c(0, 0) - c(1, 1)), c(0, 1));
  const double sigma = std::sqrt(std::max(0.0, mean + off)), sigma_deg = rad_to_deg(std::sqrt(std::max(0.0, c(2, 2))));
  const Pose2& pose = result.T_ref_scan;
  std::string text = result.usable ? toned("usable", Tone::kGood)
                                   : toned(fmt::format("not usable ({})", to_string(result.status)), Tone::kBad);
  const int decimals = decimals_of(sigma, 2, 3);
  text += fmt::format("  {}x {:.{}f} m, y {:.{}f} m, {:.{}f} deg", result.usable ? "" : "best found: ", pose.x,
                      decimals, pose.y, decimals, rad_to_deg(pose.theta), decimals_of(sigma_deg, 1, 2));
  if (result.usable) text += fmt::format("  (1 sigma {}, {:.2f} deg)", sigma_text(sigma), sigma_deg);
  if (result.confidence)
    text += fmt::format("  {:.{}f} % sure", 100.0 * *result.confidence, *result.confidence > 0.99 ? 1 : 0);
  return text;
}

}  // namespace phasescan::app
