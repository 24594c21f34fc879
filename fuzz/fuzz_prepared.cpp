// A prepared map as it is kept: as it is, and with its checksums put right, so that what is changed reaches the
// readers. What they let pass must be fit to be localised in, and come back the same.
#include <string>

#include "phasescan/localize/localizer.hpp"
#include "support/sealed_state.hpp"

namespace {

using namespace phasescan;

void read_and_locate(const std::string& bytes) {
  constexpr MapDigest kMadeOf{1, 2};
  LocalizeOptions options;
  options.view_spacing_m = 0.7;
  options.candidates = 30;
  try {
    const PreparedMap prepared = decode_prepared(bytes, kMadeOf, options);
    if (prepared.map.views() == 0) __builtin_trap();
    RangeMeasurement measurement;
    measurement.scan = make_scan(std::vector<float>(90, 1.5F), {0.0, 0.0698, 0.0, 0.0});
    static_cast<void>(locate(prepared.map, measurement, options));
    decode_prepared(encode_prepared(prepared, kMadeOf), kMadeOf, options);
  } catch (const PreparedMapError&) {
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  read_and_locate(bytes);
  read_and_locate(phasescan::testing::sealed(bytes));
  return 0;
}
