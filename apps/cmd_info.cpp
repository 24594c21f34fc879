// phasescan info LOG: what a log holds and what is wrong with it.
#include <fmt/format.h>

#include <memory>

#include "command_list.hpp"
#include "commands.hpp"
#include "eval/log_doctor.hpp"
#include "phasescan/io/error.hpp"
#include "io/log_summary.hpp"
#include "io/odometry_source.hpp"

namespace phasescan::app {
namespace {

struct InfoFlags {
  std::string log;
  LogOptions options;
  bool no_doctor = false;
};

void print_line(const std::string& name, const std::string& value) {
  print(fmt::format("{:<24} {}\n", name, value));
}

int run_info(const InfoFlags& flags) {
  const auto reader = open_log(flags.log, flags.options);
  LogSummary summary;
  LogDoctor doctor;
  OdometryJudge judge;
  InterruptGuard guard;
  Progress progress("read", 0);
  while (auto entry = reader->next()) {
    summary.add(*entry);
    judge.add(*entry, *reader);
    if (!flags.no_doctor) doctor.add(*entry);
    progress.step(summary.scans());
    if (InterruptGuard::interrupted()) break;
  }
  if (InterruptGuard::interrupted())
    warn("stopped after " + std::to_string(summary.scans()) + " scans; what follows is of these");
  if (summary.scans() == 0 && reader->damage_count() > 0) return fail_unreadable(*reader, flags.log);
  print_line("file", flags.log);
  print_line("format", reader->format());
  for (const auto& [name, value] : reader->facts()) print_line(name, value);
  for (const auto& [name, value] : summary.lines()) print_line(name, value);
  judge.finish(*reader);
  if (summary.odometry_equals_corrected()) print_line("odometry, for slam", judge.source().assumed);
  std::map<std::string, std::size_t> damages;
  for (const LogDamage& damage : reader->damages()) ++damages[damage.kind];
  print_line("damaged places", std::to_string(reader->damage_count()));
  for (const auto& [kind, count] : damages) print_line("damage, " + kind, std::to_string(count));
  for (const Finding& finding : doctor.findings(reader->facts(), reader->remarks())) {
    print(fmt::format("finding: {}\n  seen    {}\n  means   {}\n  do      {}\n", finding.kind, finding.seen,
                      finding.meaning, finding.advice));
  }
  const int code = report_damages(*reader, kDone);
  if (summary.usable_scans() > 0) return code;
  if (summary.scans() == 0) return fail_no_scan(*reader, flags.log);
  return fail(InputError(flags.log, 0, "holds no usable scan; expected at least one with a hit").what(), kAnswerIsNo);
}

}  // namespace

void add_info_command(CLI::App& app, CommandBody& body) {
  auto* command = app.add_subcommand("info", "what a log holds and what is wrong with it");
  auto flags = std::make_shared<InfoFlags>();
  command->add_option("LOG", flags->log, "a log of any readable format")->required();
  add_log_flags(*command, flags->options);
  add_to_flag(*command, flags->options);
  command->add_flag("--no-doctor", flags->no_doctor, "only what the log holds: no look for what is wrong with it");
  command->callback([flags, &body] { body = [flags] { return run_info(*flags); }; });
}

}  // namespace phasescan::app
