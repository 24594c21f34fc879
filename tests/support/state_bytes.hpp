// Any state with a `visit` as bytes, and back: what is not visited is lost.
#pragma once

#include <string>
#include <utility>

#include "odometry/state_types.hpp"
#include "state/container.hpp"
#include "state/reader.hpp"
#include "state/writer.hpp"

namespace phasescan::testing {

template <class State>
std::string to_bytes(const State& state) {
  StateWriter writer;
  writer.write(state);
  return std::move(writer.bytes);
}

template <class State>
State from_bytes(const std::string& bytes) {
  State state;
  StateReader reader(bytes, kStateFileVersion);
  reader.read(state);
  return state;
}

}  // namespace phasescan::testing
