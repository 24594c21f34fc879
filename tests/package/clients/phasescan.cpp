#include <phasescan/phasescan.hpp>

int main() {
  const phasescan::Scan none = phasescan::make_scan({}, {});
  return phasescan::match_scans(none, none).usable || phasescan::match_fft_icp(none, none).usable ? 1 : 0;
}
