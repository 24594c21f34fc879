// What another user may not do, for tests that root runs.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <functional>
#include <string>

#include "phasescan/io/error.hpp"

namespace phasescan::test {

/// What a user who is nobody reads, of a call that fails.
inline std::string told_to_nobody(const std::function<void()>& call) {
  int pipe[2];
  if (::pipe(pipe) != 0) return "no pipe";
  const pid_t child = ::fork();
  if (child == 0) {
    std::string text = "not refused";
    constexpr uid_t kNobody = 65534;
    if (::setgid(kNobody) != 0 || ::setuid(kNobody) != 0) ::_exit(1);
    try {
      call();
    } catch (const SystemError& error) {
      text = error.what();
    }
    if (::write(pipe[1], text.data(), text.size()) < 0) ::_exit(1);
    ::_exit(0);
  }
  ::close(pipe[1]);
  std::string text(4096, '\0');
  const ssize_t n = ::read(pipe[0], text.data(), text.size());
  text.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
  ::close(pipe[0]);
  ::waitpid(child, nullptr, 0);
  return text;
}

}  // namespace phasescan::test
