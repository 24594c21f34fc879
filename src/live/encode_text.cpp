// Blocks of SCIP 2.0 and telegrams of CoLa A.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "live/encode.hpp"
#include "live/hokuyo.hpp"

namespace phasescan::live {

std::string scip_answer(const std::string& echo, const std::string& status, std::span<const std::string> lines) {
  std::string text = echo + "\n" + status + scip::line_sum(status) + "\n";
  for (const std::string& line : lines) text += line + "\n";
  return text + "\n";
}

std::string scip_parameter(const std::string& text) {
  return text + ";" + scip::line_sum(text);
}

std::string scip_scan(const std::string& echo, const std::string& status, std::uint32_t ms, WireSamples samples) {
  std::string data;
  for (const WireSample& sample : samples)
    data += scip::text(static_cast<std::uint32_t>(std::lround(std::clamp(sample.mm, 0.0, 262143.0))), 3);
  const std::string stamp = scip::text(ms & 0xFFFFFF, 4);
  std::vector<std::string> lines = {stamp + scip::line_sum(stamp)};
  for (std::size_t at = 0; at < data.size(); at += scip::kLine) {
    const std::string line = data.substr(at, scip::kLine);
    lines.push_back(line + scip::line_sum(line));
  }
  return scip_answer(echo, status, lines);
}

std::string sick_scan(const std::string& command, std::uint32_t started_us, double turns_hz, double start_deg,
                      double step_deg, WireSamples samples) {
  const auto tenths = [](double deg) { return static_cast<std::int32_t>(std::lround(1e4 * deg)); };
  std::string text = fmt::format(
      "\x02{} LMDscandata 1 1 89A27F 0 0 343 347 {:X} {:X} 0 0 7 0 0 {:X} 168 0 1 DIST1 3F800000 "
      "00000000 {:X} {:X} {:X}",
      command, started_us, started_us, std::lround(100.0 * turns_hz), static_cast<std::uint32_t>(tenths(start_deg)),
      tenths(step_deg), samples.size());
  for (const WireSample& sample : samples) text += fmt::format(" {:X}", std::lround(std::max(0.0, sample.mm)));
  return text + " 0 0 0 0 0 0\x03";
}

}  // namespace phasescan::live
