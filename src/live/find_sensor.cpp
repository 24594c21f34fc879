#include "live/find_sensor.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>

#include "live/port.hpp"
#include "live/rplidar.hpp"
#include "live/ydlidar_request.hpp"

namespace phasescan::live {
namespace {

using Clock = std::chrono::steady_clock;

// The bauds of the families, the commonest first. In each a sensor that talks is heard within two packets.
constexpr int kBauds[] = {115200, 230400, 460800, 256000, 128000, 1000000, 512000, 921600};
constexpr auto kListen = std::chrono::milliseconds(100), kAnswer = std::chrono::milliseconds(60);
// Of a head that stood: it sends nothing before it turns.
constexpr auto kSpinUp = std::chrono::milliseconds(800);
constexpr std::uint64_t kEnoughPackets = 3;  // right ones in a row are no chance

struct Listener {
  const SensorModel* model;
  std::unique_ptr<Decoder> decoder;
  Decoded decoded;
};

/// The usual model of each protocol that this baud has.
std::vector<Listener> listeners_at(int baud) {
  std::vector<Listener> all;
  for (const SensorModel& model : sensor_models()) {
    const auto same = [&](const Listener& other) { return other.model->protocol == model.protocol; };
    const bool any_baud = model.protocol == Protocol::kHokuyo && baud == kBauds[0];  // by USB
    if ((model.baud != baud && !any_baud) || std::any_of(all.begin(), all.end(), same)) continue;
    all.push_back({&model, make_decoder(model, bytes_per_second(model)), {}});
  }
  return all;
}

class Probe {
 public:
  Probe(Port& port, int baud, std::size_t& heard) : port_(port), listeners_(listeners_at(baud)), heard_(heard) {}

  /// Who is understood, within a time.
  const SensorModel* listen(Clock::duration time) {
    const auto until = Clock::now() + time;
    std::array<std::uint8_t, 2048> bytes;
    while (Clock::now() < until) {
      const std::size_t n = port_.read(bytes, 10);
      heard_ += n;
      for (Listener& listener : listeners_) {
        listener.decoder->feed({bytes.data(), n}, 0, listener.decoded);
        if (understood(listener)) return listener.model;
        listener.decoded.beams.clear();
      }
    }
    return nullptr;
  }

  bool has(Protocol protocol) const {
    return std::any_of(listeners_.begin(), listeners_.end(),
                       [&](const Listener& listener) { return listener.model->protocol == protocol; });
  }

 private:
  static bool understood(const Listener& listener) {
    const bool asks = listener.model->protocol == Protocol::kRplidar;
    const auto answers = [&](int type) {
      return std::any_of(listener.decoded.replies.begin(), listener.decoded.replies.end(),
                         [&](const Reply& reply) { return reply.type == type; });
    };
    // RPLIDAR's and YDLIDAR's answers have the same head: what was asked decides who may have answered.
    if (asks) return answers(rplidar::kInfoAnswer);
    if (listener.model->protocol == Protocol::kYdlidar && answers(rplidar::kInfoAnswer)) return true;
    if (listener.model->protocol == Protocol::kHokuyo) return !listener.decoded.replies.empty();
    const StreamCounts counts = listener.decoder->counts();
    return counts.packets >= kEnoughPackets && counts.packets > counts.bad;
  }

  Port& port_;
  std::vector<Listener> listeners_;
  std::size_t& heard_;
};

const SensorModel* probe(Port& port, int baud, std::size_t& heard) {
  port.set_dtr(false);  // an RPLIDAR's motor turns; a YDLIDAR that talks unasked needs it set
  if (const SensorModel* found = Probe(port, baud, heard).listen(kListen)) return found;
  Probe asked(port, baud, heard);
  if (asked.has(Protocol::kRplidar)) {
    port.write(rplidar::request(rplidar::kStop));
    Probe(port, baud, heard).listen(std::chrono::milliseconds(20));
    port.write(rplidar::request(rplidar::kInfo));
    if (const SensorModel* found = asked.listen(kAnswer)) return found;
  }
  if (asked.has(Protocol::kYdlidar)) {
    port.set_dtr(true);
    // It answers as an RPLIDAR would, to a question that an RPLIDAR does not know.
    port.write(kYdlidarInfo);
    Probe again(port, baud, heard);
    const SensorModel* found = again.listen(kAnswer);
    if (found != nullptr && found->protocol == Protocol::kRplidar) {
      for (const SensorModel& model : sensor_models()) {
        if (model.protocol == Protocol::kYdlidar && model.baud == baud) return &model;
      }
    }
    if (found != nullptr) return found;
  }
  if (asked.has(Protocol::kLds01)) {
    constexpr std::uint8_t kBegin[] = {'b'};
    port.write(kBegin);
    if (const SensorModel* found = asked.listen(kSpinUp)) return found;
  }
  if (asked.has(Protocol::kHokuyo)) {
    constexpr std::uint8_t kQuit[] = {'\n', 'Q', 'T', '\n'};
    port.write(kQuit);
    if (const SensorModel* found = asked.listen(kAnswer)) return found;
  }
  return nullptr;
}

}  // namespace

const SensorModel* find_sensor_at(const std::string& path, const std::function<bool()>& stop, std::size_t& heard) {
  for (const int baud : kBauds) {
    if (stop()) return nullptr;
    try {
      const std::unique_ptr<Port> port = open_serial(path, baud);
      if (const SensorModel* found = probe(*port, baud, heard)) return found;
    } catch (const PortGone&) {
      return nullptr;
    }
  }
  return nullptr;
}

}  // namespace phasescan::live
