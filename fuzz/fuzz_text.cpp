// The other text files: relations, trajectories, pairs.
#include "fuzz_file.hpp"
#include "eval/relations.hpp"
#include "io/pairs.hpp"
#include "io/tum.hpp"

namespace {

template <class Read>
void expect_input_error_at_worst(Read read) {
  try {
    read();
  } catch (const phasescan::InputError&) {
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const phasescan::fuzz::MemoryFile file(data, size);
  expect_input_error_at_worst([&] { static_cast<void>(phasescan::read_relations(file.path())); });
  expect_input_error_at_worst([&] { static_cast<void>(phasescan::read_tum(file.path())); });
  expect_input_error_at_worst([&] { static_cast<void>(phasescan::read_pairs(file.path())); });
  return 0;
}
