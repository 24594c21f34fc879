// Runs the built command as a user would: arguments in; standard output, standard error and exit code out.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include "support/paths.hpp"
#include "support/temp.hpp"

namespace phasescan::test {

struct CommandResult {
  int code = -1;  ///< exit code; 128 + signal if it was killed by one
  std::string out, err;
};

inline std::string slurp(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// `interrupt`: sends this signal (SIGINT is Ctrl-C) once `interrupt_ready()` is true or the command has ended by
/// itself. `out`: where standard output goes instead of being collected (e.g. /dev/full).
inline CommandResult run_command(const std::vector<std::string>& arguments, const std::string& out = "",
                                 int interrupt = 0, const std::function<bool()>& interrupt_ready = {}) {
  const TempFolder folder;
  const std::string out_path = out.empty() ? folder / "out" : out, err_path = folder / "err";
  std::vector<std::string> words{command_path()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    ::dup2(::open("/dev/null", O_RDONLY), STDIN_FILENO);
    ::dup2(::open(out_path.c_str(), O_WRONLY | O_CREAT, 0600), STDOUT_FILENO);
    ::dup2(::open(err_path.c_str(), O_WRONLY | O_CREAT, 0600), STDERR_FILENO);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  int status = 0;
  if (interrupt != 0) {
    while (::waitpid(child, &status, WNOHANG) == 0) {
      if (interrupt_ready()) {
        ::kill(child, interrupt);
        ::waitpid(child, &status, 0);
        break;
      }
      ::usleep(2000);
    }
  } else {
    ::waitpid(child, &status, 0);
  }
  CommandResult result;
  result.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  if (out.empty()) result.out = slurp(out_path);
  result.err = slurp(err_path);
  return result;
}

}  // namespace phasescan::test
