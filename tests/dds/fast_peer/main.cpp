// Another host on the network, by other hands: Fast DDS and Fast CDR with the types of ROS 2 written out once more.
// Says scans of a log and listens to what phasescan says; prints a JSON line for each message that came.
//
//   fast_peer --domain N --seconds S [--address OWN] [--scans LOG.jsonl --rate HZ [--odometry] [--no-mounting]
//             [--first K] [--count N]] [--mangle KIND] [--pose X,Y,THETA] [--publishers N]
//             [--pause-at K --pause-s S]
//
// It says nothing for S seconds after K scans.
// KIND: nan, empty, beams, jump, noframe; each spoils every tenth scan.
#include <chrono>
#include <cstring>
#include <memory>
#include <thread>

#include "dds/fast_peer/talker.hpp"

using namespace fast_peer;
using Clock = std::chrono::steady_clock;

int main(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    const bool value = i + 1 < argc && std::strncmp(argv[i + 1], "--", 2) != 0;
    options.values[name] = value ? argv[++i] : "";
  }
  Peer peer(static_cast<int>(options.number("--domain", 0)),
            options.has("--address") ? options.values.at("--address") : "127.0.0.1");
  if (options.has("--hear-scans"))
    peer.listen("/scan", "rt/scan", "sensor_msgs::msg::dds_::LaserScan_", false, false, read_scan);
  peer.listen_to_all();
  std::unique_ptr<Talker> talker;
  if (options.has("--scans")) talker = std::make_unique<Talker>(peer, options);
  const auto start = Clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  const double until = options.number("--seconds", 10.0), period = 1.0 / options.number("--rate", 10.0);
  const auto pause_at = static_cast<std::size_t>(options.number("--pause-at", 0));
  double next = options.number("--after", 1.5);  // best effort and volatile: who is to listen must be there
  if (options.has("--pose")) say_pose(peer, options.values.at("--pose"));
  while (seconds() < until) {
    if (talker && !talker->done() && seconds() >= next) {
      talker->say();
      next += talker->said() == pause_at ? options.number("--pause-s", 0.0) : period;
    }
    peer.print();
    std::this_thread::sleep_for(std::chrono::microseconds(300));
  }
  return 0;
}
