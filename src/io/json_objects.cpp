#include "io/json_objects.hpp"

#include "phasescan/io/error.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kBlockBytes = std::size_t{1} << 16;

}  // namespace

bool JsonObjects::refill() {
  if (ended_) return false;
  at_ = 0;
  buffer_.resize(kBlockBytes);
  ended_ = true;  // and stays so where this throws
  buffer_.resize(stream_.read_some(buffer_));
  ended_ = buffer_.empty();
  return !ended_;
}

bool JsonObjects::next(std::string& text, long& line) {
  text.clear();
  int depth = 0;
  bool in_string = false, escaped = false;
  while (at_ < buffer_.size() || refill()) {
    const std::size_t begin = at_;
    bool complete = false;
    for (; at_ < buffer_.size() && !complete; ++at_) {
      const char c = buffer_[at_];
      line_ += c == '\n';
      if (depth == 0 && c != '{') continue;
      if (depth == 0) line = line_;
      if (in_string) {
        in_string = c != '"' || escaped;
        escaped = c == '\\' && !escaped;
        continue;
      }
      in_string = c == '"';
      depth += c == '{' ? 1 : c == '}' ? -1 : 0;
      complete = depth == 0;
    }
    // What stands before the object is not part of it.
    const std::size_t from = text.empty() ? buffer_.find('{', begin) : begin;
    if (depth > 0 || complete) text.append(buffer_, from, at_ - from);
    if (complete) return true;
    if (text.size() > LineReader::kMaxLineBytes) {
      ended_ = true;
      buffer_.clear();
      throw InputError(stream_.path(), line, "an object longer than 256 MiB; expected a scan");
    }
  }
  if (depth > 0) throw InputError(stream_.path(), line, "the JSON text is cut off; expected a whole object");
  return false;
}

}  // namespace phasescan
