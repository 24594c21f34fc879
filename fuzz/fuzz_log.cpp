// Any bytes as a log. The format is told by content, so the corpora (a folder per format) decide what is looked at.
#include "fuzz_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const phasescan::fuzz::MemoryFile file(data, size);
  phasescan::fuzz::read_log(file.path());
  return 0;
}
