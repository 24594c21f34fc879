// A sensor at a port: opened, spoken to, listened to, and opened again when it was away.
#include <array>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <optional>
#include <thread>

#include "io/file.hpp"
#include "live/clocks.hpp"
#include "live/find_sensor.hpp"
#include "live/line_damage.hpp"
#include "live/port.hpp"
#include "live/raw_file.hpp"
#include "live/session.hpp"
#include "phasescan/io/error.hpp"
#include "phasescan/live/live.hpp"
#include "phasescan/live/turns.hpp"

namespace phasescan::live {
namespace {

constexpr int kWait_ms = 20;
constexpr double kReopen_s = 0.3, kSilence_s = 3.0;

bool is_network(const std::string& port) {
  return port.starts_with("tcp:") || port.starts_with("udp:");
}

class SensorSource final : public LiveSource {
 public:
  SensorSource(std::string port, const SensorModel& model, const std::string& raw, bool file)
      : name_(std::move(port)), model_(model), file_(file) {
    if (!raw.empty()) raw_.emplace(raw, model.name);
    port_ = open();  // what is wrong with it is told before anything else begins
  }

  void run(const std::function<bool()>& stop, const std::function<void(LiveScan)>& hand,
           const std::function<void(const std::string&)>& tell) override {
    tell(std::string(model_.title) + " at " + name_ +
         (model_.baud > 0 && !file_ ? ", " + std::to_string(model_.baud) + " baud" : ""));
    while (!stop()) {
      if (!port_ && !reopen(tell)) continue;
      try {
        listen(stop, hand, tell);
      } catch (const PortGone& gone) {
        port_.reset();
        if (file_) break;
        tell(name_ + ": " + gone.why + "; waiting until it is back");
        away_ = true;
      }
    }
    if (raw_failure_) throw *raw_failure_;
    if (raw_) raw_->commit();
  }

 private:
  std::unique_ptr<Port> open() const {
    return file_ ? open_raw(name_, bytes_per_second(model_)) : open_port(name_, model_.baud);
  }

  /// Where the disk is full tracking goes on.
  void keep(std::span<const std::uint8_t> bytes, Stamp now, const std::function<void(const std::string&)>& tell) {
    try {
      raw_->write(bytes, now);
    } catch (const SystemError& error) {
      raw_failure_ = error;
      raw_.reset();
      tell(std::string(error.what()) + "; bytes are kept no more, tracking goes on");
    }
  }

  bool reopen(const std::function<void(const std::string&)>& tell) {
    std::this_thread::sleep_for(std::chrono::duration<double>(kReopen_s));
    try {
      port_ = open();
    } catch (const SystemError&) {
      return false;
    }
    tell(name_ + ": there again");
    return true;
  }

  /// One stay of the sensor at the port. Ends by `stop` or PortGone.
  void listen(const std::function<bool()>& stop, const std::function<void(LiveScan)>& hand,
              const std::function<void(const std::string&)>& tell) {
    const auto decoder = make_decoder(model_, is_network(name_) ? 0.0 : bytes_per_second(model_));
    const auto session = make_session(model_);
    TurnAssembler turns;
    std::array<std::uint8_t, 4096> bytes;
    Decoded decoded;
    std::vector<Scan> scans;
    std::optional<Stamp> last;
    int attempt = 0;
    StreamCounts before;
    Stamp since = system_ns();
    double patience_s = std::max(kSilence_s, session->grace_s());
    bool told_silence = false;
    std::string told_trouble;
    const auto order = [&](auto&& fill) {
      Orders orders;
      fill(orders);
      if (orders.dtr) port_->set_dtr(*orders.dtr);
      if (!orders.bytes.empty()) port_->write(orders.bytes);
    };
    order([&](Orders& orders) { session->start(system_ns(), attempt, orders); });
    while (!stop()) {
      const std::size_t n = port_->read(bytes, kWait_ms);
      const Stamp now = system_ns();
      const std::int64_t arrived = steady_ns();
      if (n > 0 && raw_) keep({bytes.data(), n}, now, tell);
      decoded.clear();
      decoder->feed({bytes.data(), n}, now, decoded);
      order([&](Orders& orders) {
        session->heard(decoded, now, orders);
        session->tick(now, orders);
      });
      turns.add(decoded.beams, decoder->range_min(), decoder->range_max(), scans);
      for (Scan& scan : scans) {
        since = now;
        told_silence = false;
        const double lost = lost_share(scan, last);
        last = scan.stamp;
        hand({{std::move(scan), std::string(model_.name)}, arrived, false, lost});
      }
      scans.clear();
      if (const std::string trouble = session->trouble(); trouble != told_trouble) {
        told_trouble = trouble;
        if (!trouble.empty()) tell(name_ + ": " + trouble);
      }
      if (file_ || stamp_to_seconds(now - since) < (told_silence ? patience_s : kSilence_s)) continue;
      if (!told_silence) tell(name_ + ": " + why_no_scan(decoder->counts(), before));
      told_silence = true;
      if (stamp_to_seconds(now - since) < patience_s) continue;
      before = decoder->counts();
      turns.restart();
      since = now;
      order([&](Orders& orders) { session->start(now, ++attempt, orders); });
      told_silence = false;
      patience_s = std::min(30.0, 2.0 * patience_s);
    }
    order([&](Orders& orders) { session->stop(orders); });
  }

  /// For people, of a sensor that gives no scan.
  std::string why_no_scan(const StreamCounts& now, const StreamCounts& before) const {
    const std::string no_scan = "no scan for 3 s: ";
    if (now.bytes == before.bytes)
      return no_scan + "nothing comes; is the sensor powered, does its head turn, is this its port?";
    if (now.packets == before.packets)
      return no_scan + "what comes is nothing that a " + std::string(model_.title) +
             " sends; is it another sensor (--sensor), or another baud?";
    if (now.bad - before.bad > now.packets - before.packets)
      return no_scan + "most packets arrive damaged; try a shorter cable or another USB adapter";
    return no_scan + "packets come, but no whole turn; does the head turn freely?";
  }

  std::string name_;
  SensorModel model_;
  bool file_, away_ = false;
  std::optional<RawWriter> raw_;
  std::optional<SystemError> raw_failure_;
  std::unique_ptr<Port> port_;
};

struct Answer {
  const SensorModel* model = nullptr;
  std::size_t heard = 0;
  std::optional<SystemError> refused;
};

/// All ports at once: each takes up to two seconds.
std::vector<Answer> ask_all(const std::vector<ListedPort>& ports) {
  std::vector<Answer> answers(ports.size());
  std::atomic<bool> found = false;
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < ports.size(); ++i) {
    threads.emplace_back([&, i] {
      try {
        answers[i].model = find_sensor_at(
            ports[i].path, [&] { return found.load(); }, answers[i].heard);
        if (answers[i].model != nullptr) found = true;
      } catch (const SystemError& error) {
        answers[i].refused = error;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  return answers;
}

[[noreturn]] void nothing_found(const std::vector<ListedPort>& ports, std::size_t heard) {
  if (ports.empty())
    throw SystemError("--port auto",
                      "no serial port found; is the sensor plugged in? Name its port if the system does not list it");
  std::string names;
  for (const ListedPort& port : ports) names += (names.empty() ? "" : ", ") + port.path;
  throw SystemError("--port auto", "no known sensor answers at " + names +
                                       (heard > 0 ? "; bytes come that nothing here understands: name it with --sensor"
                                                  : "; is it powered? Name it with --port and --sensor"));
}

}  // namespace

std::unique_ptr<LiveSource> open_sensor(const std::string& port, const std::string& sensor, const std::string& raw) {
  const SensorModel* model = sensor.empty() ? nullptr : find_sensor(sensor);
  if (!sensor.empty() && model == nullptr)
    throw std::invalid_argument("--sensor: " + quote_text(sensor) +
                                " is not known; expected one that `phasescan live --list` names");
  const bool file = !is_network(port) && port != "auto" && std::filesystem::is_regular_file(port);
  if (file && model == nullptr) {
    const std::string name = raw_sensor(port);
    model = find_sensor(name);
    if (model == nullptr)
      throw InputError(port, 0, "does not say of which sensor its bytes are; expected --sensor with it");
  }
  if (is_network(port) && model == nullptr)
    throw std::invalid_argument("--port: " + quote_text(port) +
                                " does not say which sensor it is; expected --sensor with it");
  if (model != nullptr && port != "auto") return std::make_unique<SensorSource>(port, *model, raw, file);
  const std::vector<ListedPort> ports = port == "auto" ? list_ports() : std::vector<ListedPort>{{port, ""}};
  if (model != nullptr && !ports.empty()) return std::make_unique<SensorSource>(ports.front().path, *model, raw, false);
  std::size_t heard = 0;
  std::optional<SystemError> refused;
  const std::vector<Answer> answers = ask_all(ports);
  for (std::size_t i = 0; i < ports.size(); ++i) {
    heard += answers[i].heard;
    if (answers[i].refused) refused = answers[i].refused;
    if (answers[i].model != nullptr)
      return std::make_unique<SensorSource>(ports[i].path, *answers[i].model, raw, false);
  }
  if (refused) throw *refused;
  nothing_found(ports, heard);
}

}  // namespace phasescan::live
