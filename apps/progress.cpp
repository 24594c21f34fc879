#include "progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <utility>

#include "phasescan/io/log.hpp"

namespace phasescan::app {
namespace {

constexpr double kBetweenLines = 0.1;  // [s]
constexpr double kFirstGuess = 1.0;    // [s] of work before the time left is told
constexpr int kBar = 24;               // characters

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

std::string duration_text(double seconds) {
  const auto whole = static_cast<long>(seconds + 0.5);
  if (whole < 100) return fmt::format("{} s", whole);
  const long minutes = (whole + 30) / 60;
  if (minutes < 60) return fmt::format("{} min", minutes);
  return fmt::format("{} h {:02} min", minutes / 60, minutes % 60);
}

Progress::Progress(std::string what, std::size_t total)
    : what_(std::move(what)),
      total_(total),
      on_terminal_(::isatty(STDERR_FILENO) == 1),
      start_(seconds_now()),
      next_(start_) {}

Progress::Progress(std::string what, const LogReader& log) : Progress(std::move(what), 0) {
  log_ = &log;
}

Progress::~Progress() {
  end();
}

void Progress::end() {
  if (written_) std::fputs("\r\033[K", stderr);
  written_ = on_terminal_ = false;
}

void Progress::step(std::size_t done) {
  if (!on_terminal_ || seconds_now() < next_) return;
  next_ = seconds_now() + kBetweenLines;
  if (log_ != nullptr) return show(done, log_->share_read());
  show(done, total_ > 0 ? std::optional(static_cast<double>(std::min(done, total_)) / static_cast<double>(total_))
                        : std::nullopt);
}

void Progress::show(std::size_t done, std::optional<double> share) {
  const double spent = seconds_now() - start_;
  std::string line = what_;
  if (share) {
    const auto bars = static_cast<std::size_t>(*share * kBar);
    line += fmt::format(" [{:<{}}] {:3.0f} %", std::string(bars, '#'), kBar, 100.0 * *share);
    if (spent > kFirstGuess && *share > 0.01)
      line += fmt::format(", {} left", duration_text(spent * (1.0 - *share) / *share));
  } else {
    line += fmt::format(" {}", done);
    if (spent > kFirstGuess) line += fmt::format(", {:.0f} per second", static_cast<double>(done) / spent);
  }
  std::fprintf(stderr, "\r%s\033[K", line.c_str());
  std::fflush(stderr);
  written_ = true;
}

}  // namespace phasescan::app
