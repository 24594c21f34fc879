// Not all is public yet where slam.hpp stands: the components' main headers, with all libraries linked.
#include <phasescan/fft_icp/fft_icp.hpp>
#include <phasescan/io/log.hpp>
#include <phasescan/match/scan_matcher.hpp>

int main() {
  const phasescan::Scan none = phasescan::make_scan({}, {});
  return phasescan::match_scans(none, none).usable || phasescan::match_fft_icp(none, none).usable ? 1 : 0;
}
