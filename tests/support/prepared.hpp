/// A scan prepared with the defaults of the global matcher, for tests of its parts.
#pragma once

#include "match/prepared_scan.hpp"

namespace phasescan::test {

inline PreparedScan prepared(const Scan& scan) {
  PreparedScan out;
  PrepareWorkspace work;
  prepare_scan(scan, {}, {}, work, out);
  return out;
}

}  // namespace phasescan::test
