// A text log with named columns: the first line is --columns, the rest the file.
#include <algorithm>

#include "fuzz_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::uint8_t* end = std::find(data, data + size, '\n');
  phasescan::LogOptions options;
  options.columns.assign(data, end);
  if (options.columns.empty()) return 0;
  if (end != data + size) ++end;
  const phasescan::fuzz::MemoryFile file(end, static_cast<std::size_t>(data + size - end));
  phasescan::fuzz::read_log(file.path(), options);
  return 0;
}
