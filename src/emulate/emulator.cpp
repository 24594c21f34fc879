#include "emulate/emulator.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "core/random.hpp"
#include "emulate/device.hpp"
#include "emulate/link.hpp"
#include "emulate/world_feed.hpp"
#include "io/file.hpp"
#include "io/tum.hpp"

namespace phasescan::emulate {
namespace {

using namespace live;

// Sleeping takes longer by 0.1 ms than asked for: packets that are nearer to each other go together.
constexpr double kShortest_s = 3e-4;

double now_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

class Emulator {
 public:
  Emulator(const EmulatorOptions& options, const std::function<void(const std::string&)>& ready)
      : options_(options), device_(make_device(options.model, options.faults.health)), noise_(options.seed) {
    plug_in();
    ready(link_->name());
  }

  EmulatorReport run(const std::function<bool()>& stop) {
    while (!stop()) {
      serve_client();
      if (!device_->state().streaming || !(began() || link_present())) continue;
      if (!pump()) break;
    }
    write_truth();
    return {packets_, began() ? now_s() - start_s_ : 0.0};
  }

 private:
  bool began() const { return start_s_ > 0.0; }
  bool link_present() { return link_ && link_->connected(); }

  void plug_in() {
    if (options_.tcp || options_.udp) {
      const int port = network_port_ != 0 ? network_port_ : options_.network_port;
      link_ = options_.udp ? open_udp_port(port) : open_tcp_port(port);
      network_port_ = std::stoi(link_->name().substr(link_->name().rfind(':') + 1));
    } else {
      link_ = open_pty(options_.alias);
    }
  }

  /// Whether a fault that begins at a time and lasts for a while is there.
  bool is_now(double on_s, double begins_s, double lasts_s) const {
    if (begins_s < 0.0 || on_s < begins_s) return false;
    const double since = on_s - begins_s;
    return (options_.faults.every_s > 0.0 ? std::fmod(since, options_.faults.every_s) : since) < lasts_s;
  }

  /// Requests in, answers out; the plug.
  void serve_client() {
    const double on_s = began() ? now_s() - start_s_ : 0.0;
    const Faults& faults = options_.faults;
    const bool away = is_now(on_s, faults.unplug_at_s, faults.replug_s);
    if (away && link_) {
      link_.reset();
      device_ = make_device(options_.model, faults.health);  // without power it forgets
    } else if (!away && !link_) {
      plug_in();
    }
    if (!link_) {
      ::usleep(2000);
      return;
    }
    const auto bytes = link_->read(device_->state().streaming ? 1 : 5);
    if (!bytes.empty() && right_baud()) device_->hear(bytes);
    for (const ByteString& answer : device_->state().answers) send(answer, false);
    device_->state().answers.clear();
  }

  bool right_baud() { return options_.model.baud == 0 || link_->baud() == 0 || link_->baud() == options_.model.baud; }

  /// The form asked for decides what the packets are: the world goes on from where the time is.
  void begin_feed() {
    const DeviceState& state = device_->state();
    if (feed_ && state.rplidar_type == form_ && state.echo == echo_) return;
    form_ = state.rplidar_type;
    echo_ = state.echo;
    const sim::LidarOptions lidar = lidar_of(options_.model, form_);
    sim::Path path(options_.world, options_.path, Random::derive(options_.seed, 1));
    sim::Drive drive(options_.world, lidar, std::move(path), {}, Random::derive(options_.seed, 2));
    feed_ = std::make_unique<WorldFeed>(options_.model, std::move(drive), lidar, form_, echo_);
    if (!began()) start_s_ = now_s();
    next_ = feed_->next();
  }

  /// Packets that are due. False at the end of the drive.
  bool pump() {
    begin_feed();
    while (next_) {
      const double due = start_s_ + next_->time_s;
      if (now_s() < due) return true;
      // What lies more than 0.2 s back was measured while nobody listened.
      if (now_s() - due < 0.2 && link_present()) send(next_->bytes, true, due);
      ++packets_;
      next_ = feed_->next();
    }
    return false;
  }

  /// At the pace of the line: a packet is there when its last byte is.
  void send(const ByteString& bytes, bool beams, double due_s = 0.0) {
    if (!link_) return;
    const Faults& faults = options_.faults;
    const double on_s = began() ? now_s() - start_s_ : 0.0;
    if (is_now(on_s, faults.stall_at_s, faults.stall_s)) return;
    if (const double rate = bytes_per_second(options_.model); rate > 0.0) {
      line_free_s_ = std::max(line_free_s_, beams ? due_s : now_s()) + static_cast<double>(bytes.size()) / rate;
      if (const double wait = line_free_s_ - now_s(); wait > kShortest_s)
        ::usleep(static_cast<useconds_t>(1e6 * std::min(wait, 0.5)));
    }
    const ByteString sent = beams ? spoiled(bytes) : bytes;
    held_.insert(held_.end(), sent.begin(), sent.end());
    if (faults.delay_s > 0.0 && beams && now_s() - held_since_s_ < faults.delay_s) return;
    held_since_s_ = now_s();
    if (!right_baud())
      for (std::uint8_t& byte : held_) byte = static_cast<std::uint8_t>(noise_.bits());
    link_->write(held_);
    held_.clear();
  }

  ByteString spoiled(const ByteString& bytes) {
    const Faults& faults = options_.faults;
    ByteString out;
    for (std::uint8_t byte : bytes) {
      if (noise_.chance(faults.drop)) continue;
      if (noise_.chance(faults.corrupt)) byte ^= static_cast<std::uint8_t>(1U << (noise_.bits() % 8));
      out.push_back(byte);
      if (noise_.chance(faults.repeat)) out.push_back(byte);
    }
    return out;
  }

  void write_truth() const {
    if (options_.truth.empty() || !feed_) return;
    std::vector<StampedPose> truth;
    for (const auto& [at_s, pose] : feed_->truth()) truth.push_back({stamp_from_seconds(start_s_ + at_s), pose});
    write_file(options_.truth, format_tum(truth));
  }

  const EmulatorOptions& options_;
  std::unique_ptr<Device> device_;
  std::unique_ptr<Link> link_;
  std::unique_ptr<WorldFeed> feed_;
  std::optional<WirePacket> next_;
  Random noise_;
  int form_ = 0, network_port_ = 0;
  std::string echo_;
  double start_s_ = 0.0, line_free_s_ = 0.0, held_since_s_ = 0.0;
  ByteString held_;
  std::size_t packets_ = 0;
};

}  // namespace

EmulatorReport run_emulator(const EmulatorOptions& options, const std::function<void(const std::string&)>& ready,
                            const std::function<bool()>& stop) {
  return Emulator(options, ready).run(stop);
}

}  // namespace phasescan::emulate
