// A YAML file of options.
#include <stdexcept>

#include "fuzz_file.hpp"
#include "config/config.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const phasescan::fuzz::MemoryFile file(data, size);
  try {
    static_cast<void>(phasescan::load_config(file.path()));
  } catch (const phasescan::InputError&) {
  }
  return 0;
}
