// What runs as a service needs: cut scans, health from outside, and files that fit the command.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <fstream>
#include <future>
#include <regex>
#include <sstream>
#include <thread>

#include "live/raw_file.hpp"
#include "live/streams.hpp"
#include "phasescan/io/log.hpp"
#include "support/command.hpp"
#include "support/paths.hpp"

namespace phasescan::service_test {
namespace {

using test::CommandResult;
using test::run_command;
using test::slurp;
using test::TempFolder;
using ::testing::HasSubstr;

/// What an LD06 sends in some turns, as `--raw` keeps it.
std::string recorded_bytes(const TempFolder& folder, int turns) {
  const std::string path = folder / "ld06.raw";
  live::RawWriter writer(path, "ld06");
  for (const live::WirePacket& packet : live::testing::packets_of(live::testing::forms().front(), turns))
    writer.write(packet.bytes, 1 + static_cast<Stamp>(1e9 * packet.time_s));
  writer.commit();
  return path;
}

std::vector<float> ranges_in(const std::string& mcap, std::size_t& scans) {
  const auto reader = open_log(mcap);
  std::vector<float> out;
  for (scans = 0; auto entry = reader->next(); ++scans) {
    for (std::size_t i = 0; i < entry->scan.size(); ++i)
      if (entry->scan.is_hit(i)) out.push_back(entry->scan.ranges[i]);
  }
  return out;
}

TEST(Service, ScansOfASensorAreCutAsThoseOfALog) {
  const TempFolder folder;
  const std::string raw = recorded_bytes(folder, 6);  // ranges of 0.6 m to 1.6 m
  const std::string all = folder / "all.mcap", near = folder / "near.mcap", file = folder / "file.mcap",
                    masked = folder / "masked.mcap";
  std::ofstream(folder / "mine.yaml") << "range_min_m: 0.8\nrange_max_m: 1.2\n";
  const auto live = [&](const std::string& mcap, std::vector<std::string> more) {
    std::vector<std::string> words = {"live", "--port", raw, "--serve", "off", "--record", mcap};
    words.insert(words.end(), more.begin(), more.end());
    const CommandResult run = run_command(words);
    EXPECT_EQ(run.code, 0) << run.err;
    std::size_t scans = 0;
    const std::vector<float> ranges = ranges_in(mcap, scans);
    EXPECT_GE(scans, 3U);
    return ranges;
  };
  const std::vector<float> full = live(all, {});
  const auto [least, most] = std::minmax_element(full.begin(), full.end());
  EXPECT_LT(*least, 0.61F);
  EXPECT_GT(*most, 1.59F);
  for (const float range : live(near, {"--range-max", "1"})) EXPECT_LE(range, 1.0F);
  for (const float range : live(file, {"--sensor", folder / "mine.yaml"})) {
    EXPECT_GE(range, 0.8F);
    EXPECT_LE(range, 1.2F);
  }
  const std::vector<float> half = live(masked, {"--mask", "0:180"});
  EXPECT_LT(10 * half.size(), 6 * full.size());
  EXPECT_GT(10 * half.size(), 4 * full.size());
  EXPECT_EQ(run_command({"live", "--port", raw, "--sensor", folder / "no.yaml"}).code, 2);
}

/// A build without Boost says so where it is asked to serve.
bool serves() {
  const CommandResult run = run_command({"live", "--demo", "--serve", "no.such.address"});
  return run.err.find("this build has no server") == std::string::npos;
}

TEST(Service, HealthIsAskedFromOutside) {
  if (!serves()) GTEST_SKIP() << "this build has no server";
  std::atomic<bool> ends = false;
  // Its address is on standard error, which is collected at the end: a fixed port of the upper range, another where
  // that is taken.
  std::string url;
  std::future<CommandResult> run;
  for (int port = 47631; port < 47640; ++port) {
    url = "http://127.0.0.1:" + std::to_string(port);
    run = std::async(std::launch::async, [&, port] {
      return run_command({"live", "--demo", "--serve", "127.0.0.1:" + std::to_string(port)}, "", SIGINT,
                         [&] { return ends.load(); });
    });
    if (run.wait_for(std::chrono::milliseconds(1500)) == std::future_status::timeout) break;
  }
  CommandResult health;
  for (int i = 0; i < 100 && health.code != 0; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    health = run_command({"live", "--health", url});
  }
  EXPECT_EQ(health.code, 0) << health.err;
  EXPECT_THAT(health.out, HasSubstr("ok: "));
  EXPECT_THAT(health.out, HasSubstr("scans/s"));
  ends = true;
  EXPECT_EQ(run.get().code, 130);
  const CommandResult nobody = run_command({"live", "--health", url});
  EXPECT_EQ(nobody.code, 3);
  EXPECT_THAT(nobody.err, HasSubstr("cannot be reached"));
  for (const char* wrong : {"http://", "http://host:0", "http://host:99999/", "http://a b:80?x y"})
    EXPECT_EQ(run_command({"live", "--health", wrong}).code, 2) << wrong;
}

TEST(Service, ARunWithoutScansIsNotWell) {
  if (!serves()) GTEST_SKIP() << "this build has no server";
  const TempFolder folder;
  const std::string raw = folder / "silent.raw";
  {
    live::RawWriter writer(raw, "ld06");
    const std::uint8_t byte = 0;
    writer.write({&byte, 1}, 1);
    writer.write({&byte, 1}, 60'000'000'000);
    writer.commit();
  }
  std::atomic<bool> ends = false;
  auto run = std::async(std::launch::async, [&] {
    return run_command({"live", "--port", raw, "--serve", "127.0.0.1:47641"}, "", SIGINT, [&] { return ends.load(); });
  });
  CommandResult health;
  for (int i = 0; i < 50 && health.code != 1; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    health = run_command({"live", "--health", "127.0.0.1:47641"});
  }
  EXPECT_EQ(health.code, 1) << health.err;
  EXPECT_THAT(health.out, HasSubstr("waiting"));
  ends = true;
  run.get();
}

TEST(Service, TheUnitsFlagsAreThoseOfTheCommand) {
  const std::string unit = slurp(test::source_dir() + "/configs/service/phasescan-live.service");
  const std::string help = run_command({"live", "--help"}).out;
  const std::regex flag("--[a-z][a-z-]*");
  std::size_t flags = 0;
  const std::size_t begin = unit.find("ExecStart="), end = unit.find('\n', begin);
  ASSERT_NE(begin, std::string::npos);
  const std::string line = unit.substr(begin, end - begin);
  for (std::sregex_iterator at(line.begin(), line.end(), flag), none; at != none; ++at, ++flags)
    EXPECT_THAT(help, HasSubstr(at->str()));
  EXPECT_GE(flags, 5U);
}

TEST(Service, WhereTheDiskIsFullForBytesTrackingGoesOn) {
  const TempFolder folder;
  const std::string raw = recorded_bytes(folder, 8), again = folder / "again.raw";
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const rlimit limit{4000, before.rlim_max};
  ::signal(SIGXFSZ, SIG_IGN);
  ::setrlimit(RLIMIT_FSIZE, &limit);
  const CommandResult run = run_command({"live", "--port", raw, "--serve", "off", "--raw", again});
  ::setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(run.code, 3) << run.err;
  EXPECT_THAT(run.err, HasSubstr("bytes are kept no more, tracking goes on"));
  EXPECT_FALSE(std::ifstream(again).good());
}

TEST(Service, EventsAreOneLineEachWhereNobodySits) {
  const TempFolder folder;
  const std::string raw = recorded_bytes(folder, 8);
  const CommandResult run = run_command({"live", "--port", raw, "--serve", "off"});
  std::istringstream lines(run.err);
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    EXPECT_THAT(line, ::testing::StartsWith("phasescan: "));
    EXPECT_EQ(line.find('\r'), std::string::npos);
  }
  EXPECT_LE(count, 15) << run.err;
}

}  // namespace
}  // namespace phasescan::service_test
