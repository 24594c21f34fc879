/// Failures of input and of the system, with the exit code each one means (docs: exit codes).
#pragma once

#include <stdexcept>
#include <string>

namespace phasescan {

/// Bad input: exit 2, "FILE:LINE: what is wrong and what was expected". line 0 = no line (binary or whole file).
class InputError : public std::runtime_error {
 public:
  InputError(std::string file, long line, const std::string& reason)
      : std::runtime_error(line > 0 ? file + ":" + std::to_string(line) + ": " + reason : file + ": " + reason),
        file_(std::move(file)),
        line_(line),
        reason_(reason) {}
  const std::string& file() const { return file_; }
  long line() const { return line_; }
  /// What is wrong and what was expected, without the place.
  const std::string& reason() const { return reason_; }

 private:
  std::string file_;
  long line_;
  std::string reason_;
};

/// The system said no (permission, disk full, device gone): exit 3.
class SystemError : public std::runtime_error {
 public:
  SystemError(const std::string& file, const std::string& reason) : std::runtime_error(file + ": " + reason) {}
};

}  // namespace phasescan
