/// Bytes of a plugged-in lidar in, beams out. No clock and no port of its own: who feeds it says when bytes arrived.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "phasescan/core/time.hpp"
#include "phasescan/live/sensors.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan::live {

/// Where a beam stands in its turn.
enum class TurnMark : std::uint8_t {
  kInside,
  kStarts,    ///< the first of a turn
  kRestarts,  ///< the sensor began anew: what came of this turn before is void
};

/// One range as a sensor says it.
struct Beam {
  double angle = 0.0;  ///< direction [rad], counter-clockwise from x forward; any turn
  /// How far the head has turned since its zero, in its own sense, [0, 2 pi); before any correction by the range. NaN:
  /// the sensor does not say.
  double sweep = std::numeric_limits<double>::quiet_NaN();
  float range_m = 0.0F;  ///< 0 where there is none
  BeamState state = BeamState::kNoReturn;
  float intensity = 0.0F;
  Stamp stamp = 0;  ///< when it was measured, by the clock that the arrivals were told in
  TurnMark mark = TurnMark::kInside;
  bool ends_turn = false;  ///< the last of a turn that is sent as a whole
};

/// An answer to a request, or what stands for one.
struct Reply {
  static constexpr int kBanner = 0x100;  ///< the sensor was switched on: its greeting
  int type = 0;                          ///< of the protocol; RPLIDAR: the descriptor's
  std::vector<std::uint8_t> bytes;       ///< text protocols: a line
};

/// What a piece of the stream brought.
struct Decoded {
  std::vector<Beam> beams;
  std::vector<Reply> replies;

  void clear() {
    beams.clear();
    replies.clear();
  }
};

/// What came over the line so far.
struct StreamCounts {
  std::uint64_t bytes = 0;
  std::uint64_t packets = 0;  ///< whose check is right
  std::uint64_t bad = 0;      ///< that begin like one and whose check is wrong, or that say what cannot be
  std::uint64_t skipped = 0;  ///< bytes that belong to no packet
};

/// Finds packets in a stream, checks them, says what beams are in them. Resynchronises by itself; holds a bounded
/// number of bytes; no beam of a packet whose check is wrong.
class Decoder {
 public:
  virtual ~Decoder() = default;

  /// The next bytes. @param arrival  when the last of them was there; never before that of the call before
  virtual void feed(std::span<const std::uint8_t> bytes, Stamp arrival, Decoded& out) = 0;

  virtual StreamCounts counts() const = 0;
  /// The limits that the sensor states, else those of the data sheet; 0: unknown. [m]
  virtual double range_min() const = 0;
  virtual double range_max() const = 0;
};

/// @param bytes_per_s  how fast the line carries bytes, to tell when a packet was sent; 0: at once, as over a network
std::unique_ptr<Decoder> make_decoder(const SensorModel& model, double bytes_per_s);

/// The line of a model: ten bits a byte.
inline double bytes_per_second(const SensorModel& model) {
  return model.baud / 10.0;
}

}  // namespace phasescan::live
