// Maps of map_server: a yaml, or the picture that it names.
#include <fstream>

#include "fuzz_file.hpp"
#include "output/grey_picture.hpp"
#include "output/map_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const phasescan::fuzz::MemoryFile file(data, size);
  try {
    const phasescan::GreyPicture picture = phasescan::read_grey_picture(file.path());
    if (picture.grey.size() != static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height))
      __builtin_trap();
    if (!picture.alpha.empty() && picture.alpha.size() != picture.grey.size()) __builtin_trap();
  } catch (const phasescan::InputError&) {
  }
  try {
    const phasescan::TrinaryMap map = phasescan::read_map(file.path());
    if (map.cells.size() != static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height))
      __builtin_trap();
  } catch (const phasescan::InputError&) {
  } catch (const phasescan::SystemError&) {  // the image it names is none that may be read
  }
  return 0;
}
