#include "live/stream_decoder.hpp"

#include <algorithm>

#include "phasescan/core/pose2.hpp"

namespace phasescan::live {

StreamDecoder::StreamDecoder(const SensorModel& model, double bytes_per_s)
    : model_(model), byte_ns_(bytes_per_s > 0.0 ? 1e9 / bytes_per_s : 0.0), zero_(deg_to_rad(model.zero_deg)) {}

void StreamDecoder::feed(Bytes bytes, Stamp arrival, Decoded& out) {
  // In pieces: what is held stays bounded, however much comes at once.
  constexpr std::size_t kPiece = 4096;
  while (!bytes.empty()) {
    const Bytes piece = bytes.first(std::min(kPiece, bytes.size()));
    bytes = bytes.subspan(piece.size());
    counts_.bytes += piece.size();
    pending_.insert(pending_.end(), piece.begin(), piece.end());
    std::size_t at = 0;
    while (at < pending_.size()) {
      const Bytes left = Bytes(pending_).subspan(at);
      Cut cut = find(left);
      if (cut.what == Cut::What::kWait && left.size() > kMostPending) cut = Cut::bad();
      if (cut.what == Cut::What::kWait) break;
      if (cut.what == Cut::What::kPacket) {
        const auto behind = static_cast<double>(bytes.size() + left.size() - cut.size);
        const Stamp last = arrival - static_cast<Stamp>(behind * byte_ns_);
        const Stamp first = last - static_cast<Stamp>(static_cast<double>(cut.size) * byte_ns_);
        ++(take(left.first(cut.size), {first, last}, out) ? counts_.packets : counts_.bad);
      } else {
        ++(cut.what == Cut::What::kBad ? counts_.bad : counts_.skipped);
        if (cut.what == Cut::What::kSkip) counts_.skipped += cut.size - 1;
      }
      at += cut.size;
    }
    pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(at));
  }
}

void StreamDecoder::put_range(Beam& beam, double metres) const {
  beam.range_m = static_cast<float>(metres);
  beam.state = BeamState::kHit;
  const double most = range_max();
  if (!(metres > 0.0)) {
    beam.range_m = 0.0F;
    beam.state = BeamState::kNoReturn;
  } else if (metres < range_min()) {
    beam.state = BeamState::kTooNear;
  } else if (most > 0.0 && metres > most) {
    beam.state = BeamState::kOutOfRange;
  }
}

std::unique_ptr<Decoder> make_decoder(const SensorModel& model, double bytes_per_s) {
  switch (model.protocol) {
    case Protocol::kRplidar:
      return make_rplidar_decoder(model, bytes_per_s);
    case Protocol::kLd06:
      return make_ld06_decoder(model, bytes_per_s);
    case Protocol::kLds01:
      return make_lds01_decoder(model, bytes_per_s);
    case Protocol::kXv11:
      return make_xv11_decoder(model, bytes_per_s);
    case Protocol::kYdlidar:
      return make_ydlidar_decoder(model, bytes_per_s);
    case Protocol::kCamsense:
      return make_camsense_decoder(model, bytes_per_s);
    case Protocol::kDelta2:
      return make_delta2_decoder(model, bytes_per_s);
    case Protocol::kHokuyo:
      return make_hokuyo_decoder(model, bytes_per_s);
    case Protocol::kSick:
      return make_sick_decoder(model, bytes_per_s);
  }
  return nullptr;
}

}  // namespace phasescan::live
