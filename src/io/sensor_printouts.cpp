// What small programs around a sensor print, a beam or a scan a line.
//
//   ultra_simple (SLAMTEC's SDK)   "S  theta: 0.30 Dist: 01759.00 Q: 47 ", S where a turn begins: degrees clockwise, mm
//   S lines (a robotics course)    "S 315 660 189 186 ..": ms, count, ranges in mm of a Hokuyo URG-04LX of 240 degrees
#include <cmath>

#include "io/log_format.hpp"
#include "io/text_log.hpp"
#include "io/text_numbers.hpp"
#include "phasescan/core/pose2.hpp"
#include "phasescan/io/scan_json.hpp"

namespace phasescan {
namespace {

constexpr double kMillimetre = 1e-3;

// --- ultra_simple ----------------------------------------------------------------------------------------------------

struct UltraSimpleBeam {
  double degrees = 0.0, millimetres = 0.0, quality = 0.0;
  bool begins_turn = false;
};

std::optional<UltraSimpleBeam> parse_ultra_simple(std::string_view line, std::vector<std::string_view>& words) {
  split_fields(line, ' ', words);
  const bool begins = !words.empty() && words[0] == "S";
  const std::size_t at = begins ? 1 : 0;
  if (words.size() != at + 6 || words[at] != "theta:" || words[at + 2] != "Dist:" || words[at + 4] != "Q:")
    return std::nullopt;
  const auto degrees = parse_number<double>(words[at + 1]), distance = parse_number<double>(words[at + 3]),
             quality = parse_number<double>(words[at + 5]);
  if (!degrees || !distance || !quality || !(std::abs(*degrees) <= 720.0)) return std::nullopt;
  return UltraSimpleBeam{*degrees, *distance, *quality, begins};
}

class UltraSimpleReader final : public TextLogReader {
 public:
  explicit UltraSimpleReader(LogInput& input) : TextLogReader(input) {}

  std::string format() const override { return "printout of ultra_simple"; }
  std::vector<LogRemark> remarks() const override {
    return {{"assumed stamps", "the printout states no times: 0.1 s a turn is assumed"}};
  }

  std::optional<LogEntry> next() override {
    std::string line;
    while (next_line(line)) {
      const auto beam = parse_ultra_simple(line, words_);
      if (!beam) {
        // The program greets and says what it found before it prints.
        if (seen_) damage_here("bad line", "no beam; expected theta, Dist and Q");
        continue;
      }
      seen_ = true;
      std::optional<LogEntry> entry;
      if (beam->begins_turn || ranges_.size() >= kMaxBeams) entry = finish_turn();
      if (ranges_.empty()) first_line_ = line_number();
      angles_.push_back(static_cast<float>(-deg_to_rad(beam->degrees)));
      ranges_.push_back(static_cast<float>(beam->millimetres * kMillimetre));
      intensities_.push_back(static_cast<float>(beam->quality));
      if (entry) return entry;
    }
    return finish_turn();
  }

 private:
  std::optional<LogEntry> finish_turn() {
    if (ranges_.empty()) return std::nullopt;
    LogEntry entry;
    entry.scan = make_scan(ranges_, {}, angles_);
    entry.scan.intensities = std::move(intensities_);
    entry.scan.stamp = turns_++ * 100'000'000;
    entry.laser = "rplidar";
    entry.line = first_line_;
    ranges_.clear();
    angles_.clear();
    intensities_.clear();
    return entry;
  }

  std::vector<std::string_view> words_;
  std::vector<float> ranges_, angles_, intensities_;
  Stamp turns_ = 0;
  long first_line_ = 0;
  bool seen_ = false;
};

bool is_ultra_simple(const LogInput& input) {
  std::string_view prefix = input.prefix();
  std::vector<std::string_view> words;
  for (int lines = 0; lines < 50 && !prefix.empty(); ++lines) {
    const std::size_t end = prefix.find('\n');
    if (parse_ultra_simple(prefix.substr(0, end), words)) return true;
    prefix.remove_prefix(end == std::string_view::npos ? prefix.size() : end + 1);
  }
  return false;
}

// --- S lines ---------------------------------------------------------------------------------------------------------

constexpr double kUrgStep = 0.006135923151543;  ///< 2 pi / 1024

/// "S time count ranges..": the ranges begin at field 3. Nothing where the line is none.
std::optional<std::vector<double>> parse_s_line(std::string_view line, std::vector<std::string_view>& words) {
  if (!line.starts_with("S ")) return std::nullopt;
  split_fields(line, ' ', words);
  words.erase(words.begin());
  std::vector<double> numbers;
  if (words.size() < 3 || !parse_numbers(words, numbers)) return std::nullopt;
  if (numbers[1] != static_cast<double>(words.size() - 2) || !(std::abs(numbers[0]) < 1e3 * kMostStampSeconds))
    return std::nullopt;
  return numbers;
}

class SLineReader final : public TextLogReader {
 public:
  explicit SLineReader(LogInput& input) : TextLogReader(input) {}

  std::string format() const override { return "S lines (time, count, ranges)"; }
  std::vector<LogRemark> remarks() const override {
    return {{"assumed angles",
             "the lines state no angles: taken as a Hokuyo URG-04LX, 0.352 deg a step, the middle "
             "one ahead, with times in ms"}};
  }

  std::optional<LogEntry> next() override {
    std::string line;
    while (next_line(line)) {
      if (!line.starts_with("S ")) continue;  // wheels, poles and landmarks stand in lines of their own
      const auto numbers = parse_s_line(line, words_);
      if (!numbers) {
        damage_here("bad line", "is no scan; expected S time count and as many ranges");
        continue;
      }
      const std::size_t n = numbers->size() - 2;
      std::vector<float> ranges(n);
      for (std::size_t i = 0; i < n; ++i) ranges[i] = static_cast<float>((*numbers)[2 + i] * kMillimetre);
      LogEntry entry;
      entry.scan = make_scan(ranges, {-static_cast<double>(n / 2) * kUrgStep, kUrgStep, 0.02, 0.0});
      entry.scan.stamp = static_cast<Stamp>(std::llround((*numbers)[0])) * 1'000'000;
      entry.laser = "scan";
      entry.line = line_number();
      return entry;
    }
    return std::nullopt;
  }

 private:
  std::vector<std::string_view> words_;
};

bool is_s_lines(const LogInput& input) {
  std::string_view prefix = input.prefix();
  std::vector<std::string_view> words;
  for (int lines = 0; lines < 20 && !prefix.empty(); ++lines) {
    const std::size_t end = prefix.find('\n');
    std::string_view line = prefix.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (parse_s_line(line, words)) return true;
    prefix.remove_prefix(end == std::string_view::npos ? prefix.size() : end + 1);
  }
  return false;
}

}  // namespace

LogFormat ultra_simple_format() {
  return {"ultra_simple", is_ultra_simple, [](LogInput& input, const LogOptions&) -> std::unique_ptr<LogReader> {
            return std::make_unique<UltraSimpleReader>(input);
          }};
}

LogFormat s_lines_format() {
  return {"S lines", is_s_lines, [](LogInput& input, const LogOptions&) -> std::unique_ptr<LogReader> {
            return std::make_unique<SLineReader>(input);
          }};
}

}  // namespace phasescan
