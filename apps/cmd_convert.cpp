// phasescan convert IN OUT: from any readable log format to any writable one.
#include <memory>

#include "command_list.hpp"
#include "commands.hpp"
#include "in_the_way.hpp"
#include "people.hpp"
#include "phasescan/core/time.hpp"
#include "phasescan/io/error.hpp"
#include "io/odometry_source.hpp"
#include "output/convert_targets.hpp"

namespace phasescan::app {
namespace {

struct ConvertFlags {
  std::string in, out, format;
  LogOptions options;
};

int run_convert(const ConvertFlags& flags) {
  const std::string target = flags.format.empty() ? convert_target_for(flags.out) : flags.format;
  refuse_in_the_way("OUT", flags.out, {flags.in}, "");
  const auto reader = open_log(flags.in, flags.options);
  const auto writer = make_convert_writer(target, flags.out);
  JudgedLog log(*reader);
  bool left_out = false;
  InterruptGuard guard;
  Progress progress("convert", *reader);
  std::size_t scans = 0;
  Stamp first = 0, last = 0;
  while (const auto entry = log.next()) {
    // The copy says no more what the poses of a mapping program are: its odometry is taken off.
    left_out = left_out || (entry->corrected && !entry->odometry);
    writer->add(*entry);
    last = entry->scan.stamp;
    if (scans == 0) first = last;
    progress.step(++scans);
    if (InterruptGuard::interrupted()) break;
  }
  if (scans == 0) {
    if (InterruptGuard::interrupted()) return stopped_with_nothing();
    if (reader->damage_count() > 0) return fail_unreadable(*reader, flags.in);
    return fail_no_scan(*reader, flags.in);
  }
  if (InterruptGuard::interrupted()) warn("stopped after " + std::to_string(scans) + " scans; the file holds these");
  progress.end();
  report_remarks(*reader, flags.in);
  const int code = report_damages(*reader, kDone);
  writer->finish();
  if (left_out) warn(flags.out + ": poses of a mapping program are not written as odometry");
  for (const std::string& loss : writer->losses()) warn(flags.out + ": " + loss);
  print_ending({{"scans", std::to_string(scans) + " in " + duration_text(stamp_to_seconds(last - first))},
                {"from", reader->format()},
                {"wrote", flags.out + " (" + target + ")"}});
  return code;
}

}  // namespace

void add_convert_command(CLI::App& app, CommandBody& body) {
  auto* command = app.add_subcommand("convert", "a log in another format");
  auto flags = std::make_shared<ConvertFlags>();
  command->add_option("IN", flags->in, "a log of any readable format")->required();
  command->add_option("OUT", flags->out, "the file to write; its ending tells the format")
      ->required()
      ->check(not_empty());
  command->add_option("--format", flags->format, "the format, whatever OUT is called")
      ->check(one_of(convert_target_names()));
  command->footer("Example:\n  phasescan convert drive.bag drive.mcap");
  add_log_flags(*command, flags->options);
  add_to_flag(*command, flags->options, convert_target_names(), &flags->format);
  command->callback([flags, &body] { body = [flags] { return run_convert(*flags); }; });
}

}  // namespace phasescan::app
