// What all decoders share: cutting a stream into packets, counting, and when a packet was sent.
#pragma once

#include <string>
#include <vector>

#include "live/packet_clock.hpp"
#include "phasescan/live/decoder.hpp"

namespace phasescan::live {

using Bytes = std::span<const std::uint8_t>;

inline std::uint16_t u16_at(Bytes bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8);
}
inline std::uint32_t u32_at(Bytes bytes, std::size_t at) {
  return u16_at(bytes, at) | static_cast<std::uint32_t>(u16_at(bytes, at + 2)) << 16;
}
inline std::uint16_t u16_be_at(Bytes bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] << 8 | bytes[at + 1]);
}

/// What stands at the front of the pending bytes.
struct Cut {
  enum class What {
    kWait,  ///< too little to tell
    kSkip,  ///< bytes that belong to no packet
    kBad,   ///< a packet that is wrong: only its first byte goes, a right one may begin within it
    kPacket,
  };
  What what = What::kWait;
  std::size_t size = 0;

  static Cut wait() { return {}; }
  static Cut skip(std::size_t n = 1) { return {What::kSkip, n}; }
  static Cut bad() { return {What::kBad, 1}; }
  static Cut packet(std::size_t n) { return {What::kPacket, n}; }
};

/// When a packet was on the line.
struct PacketTime {
  Stamp first = 0;  ///< its first byte began
  Stamp last = 0;   ///< its last byte was there
};

class StreamDecoder : public Decoder {
 public:
  StreamDecoder(const SensorModel& model, double bytes_per_s);

  void feed(Bytes bytes, Stamp arrival, Decoded& out) final;
  StreamCounts counts() const override { return counts_; }
  double range_min() const override { return model_.range_min_m; }
  double range_max() const override { return model_.range_max_m; }

 protected:
  /// Looks at the front of the pending bytes. It must not wait for more than kMostPending.
  virtual Cut find(Bytes pending) = 0;
  /// A packet whose check is right. False: it says what cannot be, and counts as bad.
  virtual bool take(Bytes packet, const PacketTime& time, Decoded& out) = 0;

  /// Directions of the model, from how far the head has turned clockwise since ahead [rad].
  double clockwise(double turned) const { return zero_ - turned; }
  double counter_clockwise(double turned) const { return zero_ + turned; }
  const SensorModel& model() const { return model_; }

  /// A range in metres, 0 and what the limits exclude with its reason.
  void put_range(Beam& beam, double metres) const;

  static constexpr std::size_t kMostPending = 1 << 16;
  PacketClock clock_;

 private:
  SensorModel model_;
  double byte_ns_, zero_;
  std::vector<std::uint8_t> pending_;
  StreamCounts counts_;
};

// One per protocol, each in its own file.
std::unique_ptr<Decoder> make_rplidar_decoder(const SensorModel& model, double bytes_per_s);
std::unique_ptr<Decoder> make_ld06_decoder(const SensorModel& model, double bytes_per_s);
std::unique_ptr<Decoder> make_lds01_decoder(const SensorModel& model, double bytes_per_s);
std::unique_ptr<Decoder> make_xv11_decoder(const SensorModel& model, double bytes_per_s);
std::unique_ptr<Decoder> make_ydlidar_decoder(const SensorModel& model, double bytes_per_s);
std::unique_ptr<Decoder> make_camsense_decoder(const SensorModel& model, double bytes_per_s);
std::unique_ptr<Decoder> make_delta2_decoder(const SensorModel& model, double bytes_per_s);
std::unique_ptr<Decoder> make_hokuyo_decoder(const SensorModel& model, double bytes_per_s);
std::unique_ptr<Decoder> make_sick_decoder(const SensorModel& model, double bytes_per_s);

}  // namespace phasescan::live
