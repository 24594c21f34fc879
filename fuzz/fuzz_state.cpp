// A saved run: as it is, and with its checksums put right, so that what is changed reaches the readers. What they let
// pass must be fit to go on with.
#include <string>

#include "phasescan/slam/state.hpp"
#include "support/sealed_state.hpp"

namespace {

constexpr std::size_t kMostScans = 64;  // that are worked on: the rest is read alone

void read_and_go_on(const std::string& bytes) {
  try {
    const phasescan::SavedRun run = phasescan::decode_state(bytes);
    static_cast<void>(phasescan::summarize(run.state));
    static_cast<void>(phasescan::encode_state(run));
    if (run.state.scans() > kMostScans) return;
    phasescan::SlamOptions options;  // its own may ask for a map of gigabytes
    options.slam = run.options.slam;
    phasescan::Slam slam(run.state, options);
    phasescan::RangeMeasurement measurement;
    measurement.scan = phasescan::make_scan(std::vector<float>(40, 2.0F), {0.0, 0.157, 0.0, 0.0});
    slam.add(measurement);
    slam.begin_session();
    static_cast<void>(slam.checkpoint());
    static_cast<void>(slam.finish());
  } catch (const phasescan::StateError&) {
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  read_and_go_on(bytes);
  read_and_go_on(phasescan::testing::sealed(bytes));
  return 0;
}
