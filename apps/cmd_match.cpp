// phasescan match: two scans, or every pair of a pairs file.
#include <filesystem>
#include <memory>
#include <optional>

#include "command_list.hpp"
#include "commands.hpp"
#include "core/parallel.hpp"
#include "phasescan/io/error.hpp"
#include "io/file.hpp"
#include "output/match_json.hpp"
#include "people.hpp"
#include "io/number.hpp"
#include "io/pairs.hpp"
#include "phasescan/io/scan_json.hpp"
#include "methods/any_matcher.hpp"
#include "report/scan_plot.hpp"

namespace phasescan::app {
namespace {

struct MatchFlags {
  CommonFlags common;
  std::string reference, scan;
  std::string pairs;
  std::string guess;
  std::string plot;
  bool json = false;

  bool as_text() const { return for_people() && !json; }
};

struct NamedScan {
  Scan scan;
  bool damaged = false;  // something before it in its log could not be read
};

// The k-th scan (from 0) of a log.
NamedScan read_log_scan(const std::string& path, std::size_t k) {
  const auto reader = open_log(path);
  for (std::size_t i = 0;; ++i) {
    auto entry = reader->next();
    if (!entry) {
      throw InputError(path, 0,
                       "has " + std::to_string(i) + " scans; expected more than " + std::to_string(k) + " for #" +
                           std::to_string(k));
    }
    if (i == k) return {std::move(entry->scan), report_damages(*reader, kDone) != kDone};
  }
}

// A scan JSON file, or LOG#k.
NamedScan read_named_scan(const std::string& name) {
  std::error_code ignored;
  const std::size_t mark = name.rfind('#');
  if (mark == std::string::npos || std::filesystem::exists(name, ignored)) {
    try {
      return {read_scan_file(name), false};
    } catch (const InputError& error) {
      throw InputError(error.file(), error.line(), error.reason() + " (the k-th scan of a log is " + name + "#k)");
    }
  }
  const auto k = parse_number<std::size_t>(std::string_view(name).substr(mark + 1));
  if (!k) throw InputError(name, 0, "has no number behind #; expected LOG#k, k from 0");
  return read_log_scan(name.substr(0, mark), *k);
}

int match_two(const MatchFlags& flags, const AnyMatchOptions& options, const MatchHints& hints) {
  const NamedScan reference = read_named_scan(flags.reference);
  const NamedScan scan = read_named_scan(flags.scan);
  const MatchResult result = match_any(reference.scan, scan.scan, options, hints);
  if (!flags.plot.empty()) {
    // Names without their folders: a title is one line.
    const auto name = [](const std::string& path) { return std::filesystem::path(path).filename().string(); };
    const std::string title =
        name(flags.scan) + " in " + name(flags.reference) + ", " + std::string(to_string(options.match.method));
    write_file(flags.plot, scan_pair_svg(reference.scan, scan.scan, result, {}, hints.guess.value_or(Pose2{}), title));
  }
  if (flags.as_text()) {
    print(match_text(result) + "\n");
    if (result.ambiguous) print("another pose explains the scans as well: a symmetric room, or a bare corridor\n");
    if (!flags.plot.empty()) print(toned("open  ", Tone::kFaint) + flags.plot + "\n");
  } else {
    print(format_match(flags.reference + " " + flags.scan, options.match.method, result, !flags.common.no_times) +
          "\n");
  }
  if (!result.usable) return kAnswerIsNo;
  return reference.damaged || scan.damaged ? kDamagedInput : kDone;
}

// The answers to some lines, in their order, from as many threads as there are matchers. A matcher keeps no memory of
// earlier pairs that an answer could depend on, so it does not matter which one gets a pair. A pair that cannot be
// matched at all becomes a bad line.
std::vector<std::string> match_lines(std::vector<PairLine>& lines, std::vector<AnyMatcher>& matchers,
                                     const MatchHints& hints, const MatchFlags& flags) {
  std::vector<std::string> answers(lines.size());
  parallel_for(lines.size(), matchers.size(), [&](std::size_t i, std::size_t worker) {
    PairLine& line = lines[i];
    if (line.pair) {
      try {
        AnyMatcher& matcher = matchers[worker];
        const MatchResult result = matcher.match(line.pair->reference, line.pair->scan, hints);
        answers[i] = flags.as_text()
                         ? line.pair->id + "  " + match_text(result)
                         : format_match(line.pair->id, matcher.options().match.method, result, !flags.common.no_times);
        return;
      } catch (const std::exception& error) {
        line.pair.reset();
        line.error = error.what();
      }
    }
    answers[i] = flags.as_text() ? "line " + std::to_string(line.line) + "  " + line.error
                                 : format_pair_error(line.line, line.error);
  });
  return answers;
}

int match_pairs(const MatchFlags& flags, const AnyMatchOptions& options, const MatchHints& hints) {
  std::vector<AnyMatcher> matchers;
  for (int k = 0; k < flags.common.threads; ++k) matchers.emplace_back(options);
  // One thread answers line by line; more take a window of lines at a time.
  const std::size_t window = matchers.size() == 1 ? 1 : 16 * matchers.size();
  PairReader reader(flags.pairs);
  InterruptGuard guard;
  Progress progress("match", 0);
  if (for_people()) progress.end();  // the answers themselves show how far it is
  std::size_t done = 0, bad = 0;
  std::string first_bad;
  std::vector<PairLine> lines;
  do {
    lines.clear();
    while (lines.size() < window) {
      auto line = reader.next();
      if (!line) break;
      lines.push_back(std::move(*line));
    }
    for (const std::string& answer : match_lines(lines, matchers, hints, flags)) print(answer + "\n");
    for (const PairLine& line : lines) {
      if (!line.pair && bad++ == 0) first_bad = InputError(flags.pairs, line.line, line.error).what();
    }
    flush();  // whoever reads along sees each answer, and a process that is ended loses none
    progress.step(done += lines.size());
  } while (lines.size() == window && !InterruptGuard::interrupted());
  if (InterruptGuard::interrupted()) {
    warn("stopped after " + std::to_string(done) + " pairs");
    return kDone;
  }
  if (bad == 0) return kDone;
  return fail(first_bad + (bad > 1 ? "; and " + std::to_string(bad - 1) + " more bad lines" : ""), kBadInput);
}

int run_match(const MatchFlags& flags) {
  const bool two = !flags.reference.empty() && !flags.scan.empty();
  if (two == !flags.pairs.empty() || (!two && !flags.reference.empty())) {
    throw std::invalid_argument("match: expected two scans, REF SCAN, or --pairs FILE");
  }
  if (!flags.pairs.empty() && !flags.plot.empty())
    throw std::invalid_argument("--plot: expected with two scans, not with --pairs");
  const AnyMatchOptions options = config_from(flags.common).match;
  MatchHints hints;
  if (!flags.guess.empty()) {
    const auto numbers = parse_numbers("--guess", flags.guess, 3);
    hints.guess = Pose2{numbers[0], numbers[1], wrap_angle(deg_to_rad(numbers[2]))};
  }
  return two ? match_two(flags, options, hints) : match_pairs(flags, options, hints);
}

}  // namespace

void add_match_command(CLI::App& app, CommandBody& body) {
  auto* command =
      app.add_subcommand("match", "the pose of one scan in another: T_ref_scan, with how far it can be trusted");
  auto flags = std::make_shared<MatchFlags>();
  command->add_option("REF", flags->reference, "reference: a scan JSON file, or LOG#k (k-th scan, from 0)");
  command->add_option("SCAN", flags->scan, "the scan whose pose is asked for, named alike");
  command->add_option("--pairs", flags->pairs, "pairs file (JSON Lines, .gz): a line of JSON for each")
      ->type_name("FILE");
  command->add_option("--guess", flags->guess, "first guess of the pose; none: any rotation is looked at")
      ->type_name("X,Y,THETA_DEG")
      ->check(not_empty());
  command->add_option("--plot", flags->plot, "figure of both scans before and after")
      ->type_name("F.svg")
      ->check(not_empty());
  command->add_flag("--json", flags->json, "JSON on a terminal too, where a line for people stands else");
  command->footer("Example:\n  phasescan match log.jsonl#0 log.jsonl#15 --plot match.svg");
  add_method_flags(*command, flags->common);
  add_config_flag(*command, flags->common);
  add_sensor_flag(*command, flags->common);
  add_threads_flag(*command, flags->common);
  add_seed_flag(*command, flags->common);
  add_no_times_flag(*command, flags->common);
  command->callback([flags, &body] { body = [flags] { return run_match(*flags); }; });
}

}  // namespace phasescan::app
