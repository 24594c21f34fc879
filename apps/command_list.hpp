// Every command, in the order of `--help`. A new one: a file apps/cmd_<name>.cpp, its line here, its line in the list.
#pragma once

#include "commands.hpp"

namespace phasescan::app {

/// Each adds a sub-command to `app` whose callback sets `body`; main runs it and turns exceptions into the one line on
/// stderr and the exit code.
void add_match_command(CLI::App& app, CommandBody& body);
void add_slam_command(CLI::App& app, CommandBody& body);
void add_localize_command(CLI::App& app, CommandBody& body);
void add_merge_command(CLI::App& app, CommandBody& body);
void add_info_command(CLI::App& app, CommandBody& body);
void add_convert_command(CLI::App& app, CommandBody& body);
void add_eval_command(CLI::App& app, CommandBody& body);
void add_simulate_command(CLI::App& app, CommandBody& body);
void add_calibrate_command(CLI::App& app, CommandBody& body);
void add_live_command(CLI::App& app, CommandBody& body);
void add_emulate_command(CLI::App& app, CommandBody& body);
void add_bench_command(CLI::App& app, CommandBody& body);
void add_retrieval_command(CLI::App& app, CommandBody& body);
void add_bench_localize_command(CLI::App& app, CommandBody& body);
void add_scaling_command(CLI::App& app, CommandBody& body);
void add_memory_command(CLI::App& app, CommandBody& body);
void add_live_memory_command(CLI::App& app, CommandBody& body);
void add_steps_command(CLI::App& app, CommandBody& body);
void add_state_bench_command(CLI::App& app, CommandBody& body);
void add_prepared_bench_command(CLI::App& app, CommandBody& body);
void add_paper_command(CLI::App& app, CommandBody& body);
void add_config_command(CLI::App& app, CommandBody& body);
void add_completion_command(CLI::App& app, CommandBody& body);
void add_man_command(CLI::App& app, CommandBody& body);

/// Those of `bench` come after it: they are its sub-commands. The last two are for packagers, and not in `--help`.
inline constexpr AddCommand kCommands[] = {
    add_match_command,       add_slam_command,           add_localize_command,    add_merge_command,
    add_info_command,        add_convert_command,        add_eval_command,        add_simulate_command,
    add_calibrate_command,   add_live_command,           add_emulate_command,     add_bench_command,
    add_retrieval_command,   add_bench_localize_command, add_scaling_command,     add_memory_command,
    add_live_memory_command, add_steps_command,          add_state_bench_command, add_prepared_bench_command,
    add_paper_command,       add_config_command,         add_completion_command,  add_man_command,
};

}  // namespace phasescan::app
