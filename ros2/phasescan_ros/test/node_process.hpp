/// A node of the package as launch files start it: a process of its own.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <map>
#include <string>
#include <thread>
#include <vector>

namespace phasescan_ros::test {

/// A restart takes two seconds at most where nothing else runs; the tests run beside compilers, so they only print it.
inline constexpr double kMostOnABusyMachine_s = 20.0;

class NodeProcess {
 public:
  /// @param parameters  name to value, as YAML has it
  NodeProcess(const std::string& executable, const std::string& name,
              const std::map<std::string, std::string>& parameters) {
    std::vector<std::string> words = {executable, "--ros-args", "-r", "__node:=" + name};
    for (const auto& [key, value] : parameters) {
      words.insert(words.end(), {"-p", key + ":=" + value});
    }
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    pid_ = fork();
    if (pid_ == 0) {
      execv(executable.c_str(), arguments.data());
      _exit(127);
    }
  }
  ~NodeProcess() { kill(); }
  NodeProcess(const NodeProcess&) = delete;
  NodeProcess& operator=(const NodeProcess&) = delete;

  bool alive() {
    if (pid_ > 0 && waitpid(pid_, &status_, WNOHANG) == pid_) pid_ = -1;
    return pid_ > 0;
  }
  /// Without a word of goodbye, as when the power goes.
  void kill() { end(SIGKILL); }
  /// As by Ctrl-C. @returns the exit status, 128 + signal where it was killed by one
  int stop() {
    end(SIGINT);
    return WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_);
  }
  /// CPU time spent so far, by user and kernel [s].
  double cpu_s() const {
    std::ifstream file("/proc/" + std::to_string(pid_) + "/stat");
    std::string word;
    double ticks = 0.0;
    for (int i = 1; file >> word && i <= 15; ++i) {
      if (i >= 14) ticks += std::stod(word);
    }
    return ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
  }

 private:
  void end(int signal) {
    if (!alive()) return;
    ::kill(pid_, signal);
    const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (alive() && std::chrono::steady_clock::now() < patience)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    if (!alive()) return;
    ADD_FAILURE() << "the node did not end within 10 s of signal " << signal;
    ::kill(pid_, SIGKILL);
    waitpid(pid_, &status_, 0);
    pid_ = -1;
  }

  pid_t pid_ = -1;
  int status_ = 0;
};

}  // namespace phasescan_ros::test
