// Logs through pipes: read once, front to back, the same as from a file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <csignal>
#include <fstream>
#include <thread>

#include "phasescan/io/scan_json.hpp"
#include "io/scan_log.hpp"
#include "phasescan/io/error.hpp"
#include "phasescan/io/log.hpp"
#include "support/command.hpp"
#include "support/recordings.hpp"
#include "support/temp.hpp"

namespace phasescan::pipe_test {
namespace {

using ::testing::HasSubstr;

/// A named pipe that gives the bytes of a file, written by a thread of its own.
class Pipe {
 public:
  Pipe(const test::TempFolder& folder, const std::string& file) : path_(folder / "pipe") {
    ::signal(SIGPIPE, SIG_IGN);  // a reader may refuse after the first bytes
    ::unlink(path_.c_str());
    EXPECT_EQ(::mkfifo(path_.c_str(), 0600), 0);
    writer_ = std::thread([this, bytes = test::slurp(file)] { std::ofstream(path_, std::ios::binary) << bytes; });
  }
  ~Pipe() { writer_.join(); }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  std::thread writer_;
};

LogEntry an_entry(int k) {
  LogEntry entry;
  std::vector<float> raw(360);
  for (std::size_t i = 0; i < raw.size(); ++i)
    raw[i] = i % 7 == 0 ? 0.0F : 1.0F + 0.01F * static_cast<float>(i) + 0.01F * static_cast<float>(k);
  entry.scan = make_scan(raw, {-3.0, 0.0166, 0.1, 12.0});
  entry.scan.stamp = 1'700'000'000'000'000'000 + k * 100'000'000LL;
  entry.odometry = Pose2{0.1 * k, -0.2, 0.3};
  entry.laser = "/scan";
  return entry;
}

std::string write_log(const test::TempFolder& folder, const std::string& name) {
  const auto writer = make_log_writer(log_target_for(name), folder / name);
  for (int k = 0; k < 200; ++k) writer->add(an_entry(k));
  writer->finish();
  return folder / name;
}

void expect_same_through_pipe(const test::TempFolder& folder, const std::string& file) {
  const test::Read from_file = test::read_all(file);
  EXPECT_FALSE(from_file.entries.empty()) << file;
  const Pipe pipe(folder, file);
  const test::Read from_pipe = test::read_all(pipe.path());
  EXPECT_EQ(from_pipe.format, from_file.format);
  EXPECT_EQ(from_pipe.damages.size(), from_file.damages.size()) << file;
  ASSERT_EQ(from_pipe.entries.size(), from_file.entries.size()) << file;
  for (std::size_t i = 0; i < from_file.entries.size(); ++i)
    EXPECT_EQ(format_log_line(from_pipe.entries[i]), format_log_line(from_file.entries[i])) << file << " " << i;
}

TEST(Pipe, TextIsReadAsFromAFile) {
  const test::TempFolder folder;
  for (const char* name : {"a.jsonl", "a.jsonl.gz", "a.log", "a.log.gz"})
    expect_same_through_pipe(folder, write_log(folder, name));
  expect_same_through_pipe(folder, folder.put("one.json", format_scan_json(an_entry(0).scan) + "\n"));
  expect_same_through_pipe(folder, folder.put("a.csv", "stamp,angle_min,angle_increment,ranges\n1,0,0.1,1,2,3\n"));
}

TEST(Pipe, RecordingsAreReadAsFromAFile) {
  const test::TempFolder folder;
  expect_same_through_pipe(folder, write_log(folder, "a.mcap"));
  folder.put("a.bag", test::rosbag1(test::messages(true, 40)));
  expect_same_through_pipe(folder, folder / "a.bag");
  test::BagStyle packed;
  packed.compression = "bz2";
  folder.put("b.bag", test::rosbag1(test::messages(true, 40), packed));
  expect_same_through_pipe(folder, folder / "b.bag");
}

TEST(Pipe, ADatabaseIsNamedAsWhatNeedsAFile) {
  const test::TempFolder folder;
  test::rosbag2_sqlite(folder / "a.db3", test::messages(false));
  const Pipe pipe(folder, folder / "a.db3");
  try {
    static_cast<void>(open_log(pipe.path()));
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("is a .db3 (sqlite3) on a pipe; expected it as a file"));
  }
}

}  // namespace
}  // namespace phasescan::pipe_test
