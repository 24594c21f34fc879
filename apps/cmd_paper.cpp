// phasescan paper: every table and figure of the paper in one run.
#include "command_list.hpp"
#include "commands.hpp"
#include "eval/paper.hpp"
#include "io/file.hpp"

namespace phasescan::app {
namespace {

struct PaperFlags {
  CommonFlags common;
  PaperOptions options;
  std::string out;
};

int run_paper_command(PaperFlags& flags) {
  flags.options.threads = flags.common.threads;
  flags.options.times = !flags.common.no_times;
  flags.options.version = PHASESCAN_VERSION;
  make_folder(flags.out);  // before the work, so that a folder that cannot be made costs no minutes
  Progress progress("paper", 7);
  std::size_t part = 0;
  const PaperFiles files = run_paper(flags.options, [&](std::string_view) { progress.step(part++); });
  make_folder(flags.out + "/figures");
  make_folder(flags.out + "/data");
  FileSet results(flags.out);
  for (const auto& [name, content] : files) {
    if (name != "report.html") results.add(name, content);
  }
  results.add("report.html", files.at("report.html"));
  results.commit();
  print(flags.out + "/report.html\n");
  return kDone;
}

}  // namespace

void add_paper_command(CLI::App& app, CommandBody& body) {
  auto* command = app.add_subcommand("paper", "every table and figure of the paper, in one run");
  auto flags = std::make_shared<PaperFlags>();
  command->add_option("--out", flags->out, "folder for report.html, figures and data")->type_name("DIR")->required();
  command->add_flag("--quick", flags->options.quick, "fewer pairs and speeds: under a minute");
  command->add_option("--pairs", flags->options.pairs, "also repeat Fig. 10 and Table 2 on these pairs files")
      ->type_name("FILE...");
  command->add_option("--seed", flags->options.seed, "seed of the simulated data")
      ->type_name("N")
      ->check(whole_number_from(0))
      ->capture_default_str();
  add_threads_flag(*command, flags->common, 2);
  add_no_times_flag(*command, flags->common);
  command->footer("Example:\n  phasescan paper --quick --out paper");
  command->callback([flags, &body] { body = [flags] { return run_paper_command(*flags); }; });
}

}  // namespace phasescan::app
