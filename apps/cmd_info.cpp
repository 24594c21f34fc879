// phasescan info LOG: what a log holds and what is wrong with it.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "command_list.hpp"
#include "commands.hpp"
#include "eval/log_doctor.hpp"
#include "phasescan/io/error.hpp"
#include "io/log_summary.hpp"
#include "info_state.hpp"
#include "io/odometry_source.hpp"
#include "saved_run.hpp"

namespace phasescan::app {
namespace {

struct InfoFlags {
  std::string log;
  LogOptions options;
  bool no_doctor = false, json = false;
};

void print_line(const std::string& name, const std::string& value) {
  print(fmt::format("{:<24} {}\n", name, value));
}

/// All that is said of a log, as lines or as one object.
struct LogReport {
  const std::string& log;
  const LogReader& reader;
  const LogSummary& summary;
  OdometrySource odometry;
  std::vector<Finding> findings;

  /// Kinds of damage and how often each was met, of the places that are kept.
  std::map<std::string, std::size_t> damages() const {
    std::map<std::string, std::size_t> counts;
    for (const LogDamage& damage : reader.damages()) ++counts[damage.kind];
    return counts;
  }
};

void print_text(const LogReport& report) {
  print_line("file", report.log);
  print_line("format", report.reader.format());
  for (const auto& [name, value] : report.reader.facts()) print_line(name, value);
  for (const auto& [name, value] : report.summary.lines()) print_line(name, value);
  if (report.summary.odometry_equals_corrected()) print_line("odometry, for slam", report.odometry.assumed);
  print_line("damaged places", std::to_string(report.reader.damage_count()));
  for (const auto& [kind, count] : report.damages()) print_line("damage, " + kind, std::to_string(count));
  for (const Finding& finding : report.findings) {
    print(fmt::format("finding: {}\n  seen    {}\n  means   {}\n  do      {}\n", finding.kind, finding.seen,
                      finding.meaning, finding.advice));
  }
}

void print_json(const LogReport& report) {
  using Json = nlohmann::ordered_json;
  Json json{{"file", report.log},
            {"format", report.reader.format()},
            {"scans", report.summary.scans()},
            {"scans_usable", report.summary.usable_scans()},
            {"duration_s", report.summary.duration_s()},
            {"odometry", {{"used", report.odometry.usable}, {"assumed", report.odometry.assumed}}},
            {"facts", Json::object()},
            {"damaged_places", report.reader.damage_count()},
            {"damages", Json::object()},
            {"findings", Json::array()}};
  for (const auto& [name, value] : report.reader.facts()) json["facts"][name] = value;
  for (const auto& [name, value] : report.summary.lines()) json["facts"][name] = value;
  for (const auto& [kind, count] : report.damages()) json["damages"][kind] = count;
  for (const Finding& finding : report.findings) {
    json["findings"].push_back(
        {{"kind", finding.kind}, {"seen", finding.seen}, {"means", finding.meaning}, {"do", finding.advice}});
  }
  print(json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n");  // names may hold bytes that are no UTF-8
}

/// Flags that cut or name parts of a log say nothing of a saved run.
void expect_no_log_flag(const CLI::App& command) {
  for (const CLI::Option* option : command.get_options()) {
    const std::string name = option->get_name();
    if (option->count() == 0 || !name.starts_with("--") || name == "--json" || name == "--no-doctor") continue;
    throw std::invalid_argument(name + ": the file is a saved run, not a log; expected no flags of logs with it");
  }
}

int run_info(const CLI::App& command, const InfoFlags& flags) {
  if (is_state_file(flags.log)) {
    expect_no_log_flag(command);
    return info_of_state(flags.log, flags.json);
  }
  const auto reader = open_log(flags.log, flags.options);
  LogSummary summary;
  LogDoctor doctor;
  OdometryJudge judge;
  InterruptGuard guard;
  Progress progress("read", *reader);
  while (auto entry = reader->next()) {
    summary.add(*entry);
    judge.add(*entry, *reader);
    if (!flags.no_doctor) doctor.add(*entry);
    progress.step(summary.scans());
    if (InterruptGuard::interrupted()) break;
  }
  progress.end();
  if (InterruptGuard::interrupted())
    warn("stopped after " + std::to_string(summary.scans()) + " scans; what follows is of these");
  if (summary.scans() == 0 && reader->damage_count() > 0) return fail_unreadable(*reader, flags.log);
  judge.finish(*reader);
  const LogReport report{flags.log, *reader, summary, judge.source(),
                         doctor.findings(reader->facts(), reader->remarks())};
  flags.json ? print_json(report) : print_text(report);
  const int code = report_damages(*reader, kDone);
  if (summary.usable_scans() > 0) return code;
  if (summary.scans() == 0) return fail_no_scan(*reader, flags.log);
  return fail(InputError(flags.log, 0, "holds no usable scan; expected at least one with a hit").what(), kAnswerIsNo);
}

}  // namespace

void add_info_command(CLI::App& app, CommandBody& body) {
  auto* command = app.add_subcommand("info", "what a log holds and what is wrong with it; what a saved run holds");
  auto flags = std::make_shared<InfoFlags>();
  command->add_option("LOG", flags->log, "a log of any readable format, or a state that slam saved")->required();
  add_log_flags(*command, flags->options);
  add_to_flag(*command, flags->options);
  command->add_flag("--no-doctor", flags->no_doctor, "only what the log holds: no look for what is wrong with it");
  command->add_flag("--json", flags->json, "one JSON object");
  command->footer("Example:\n  phasescan info drive.bag");
  command->callback([command, flags, &body] { body = [command, flags] { return run_info(*command, *flags); }; });
}

}  // namespace phasescan::app
