#include "io/file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "core/random.hpp"
#include "phasescan/io/error.hpp"
#include "io/number.hpp"
#include "support/command.hpp"
#include "support/temp.hpp"

namespace phasescan::file_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

std::size_t files_in(const std::string& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(AtomicFile, TheOldFileStaysUntilTheNewOneIsWhole) {
  const test::TempFolder folder;
  const std::string path = folder.put("f", "old");
  {
    AtomicFile file(path);
    file.write("half of");
    EXPECT_EQ(read_file(path), "old");
  }
  EXPECT_EQ(read_file(path), "old");
  EXPECT_EQ(files_in(folder.path()), 1U) << "something was left behind";
  AtomicFile file(path);
  file.write("new");
  file.commit();
  EXPECT_EQ(read_file(path), "new");
  EXPECT_EQ(files_in(folder.path()), 1U);
}

TEST(AtomicFile, ALinkStaysALinkToTheNewContent) {
  const test::TempFolder folder;
  folder.put("target", "old");
  fs::create_symlink(folder / "target", folder / "link");
  write_file(folder / "link", "new");
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(read_file(folder / "target"), "new");
}

TEST(AtomicFile, PackedContentIsTheSameBytesEachTime) {
  const test::TempFolder folder;
  const std::string content(100000, 'x');
  write_file(folder / "a.gz", content);
  write_file(folder / "b.gz", content);
  EXPECT_EQ(test::slurp(folder / "a.gz"), test::slurp(folder / "b.gz"));
  EXPECT_LT(fs::file_size(folder / "a.gz"), 1000U);
  EXPECT_EQ(read_file(folder / "a.gz"), content);
}

TEST(AtomicFile, WhatCannotBeWrittenSaysSo) {
  const test::TempFolder folder;
  EXPECT_THROW(AtomicFile(folder / "no/such/folder"), InputError);
  EXPECT_THROW(AtomicFile(folder.path()), InputError);
  EXPECT_THROW(AtomicFile(""), InputError);
  AtomicFile full("/dev/full");
  EXPECT_THROW(full.write("x"), SystemError);
}

TEST(AtomicFile, ASignalHandlerCanDropWhatIsUnfinished) {
  const test::TempFolder folder;
  const std::string path = folder.put("f", "old");
  AtomicFile file(path);
  file.write("half of");
  EXPECT_EQ(files_in(folder.path()), 2U);
  drop_unfinished_files();
  EXPECT_EQ(files_in(folder.path()), 1U);
  EXPECT_EQ(read_file(path), "old");
}

TEST(FileSet, PutsAllInPlaceOrNone) {
  const test::TempFolder folder;
  folder.put("a", "old a");
  folder.put("gone", "old");
  folder.put("other", "the user's");
  {
    FileSet files(folder.path());
    files.add("a", "new a");
    files.leave_out("gone");
    EXPECT_THROW(files.add("nowhere/b", "new b"), InputError);
  }
  EXPECT_EQ(read_file(folder / "a"), "old a");
  EXPECT_EQ(files_in(folder.path()), 3U);
  FileSet files(folder.path());
  files.add("a", "new a");
  files.add("b", "new b");
  files.leave_out("gone");
  files.leave_out("never there");
  files.commit();
  EXPECT_EQ(read_file(folder / "a"), "new a");
  EXPECT_EQ(read_file(folder / "b"), "new b");
  EXPECT_FALSE(fs::exists(folder / "gone"));
  EXPECT_EQ(files_in(folder.path()), 3U);
}

TEST(LineReader, EveryKindOfLineEndAndTheMarkAtTheStart) {
  const test::TempFolder folder;
  LineReader lines(folder.put("l", "\xEF\xBB\xBFone\r\n\ntwo\nthree"));
  std::vector<std::string> found;
  std::vector<bool> ended;
  for (std::string line; lines.next(line);) {
    found.push_back(line);
    ended.push_back(lines.line_was_ended());
  }
  EXPECT_EQ(found, (std::vector<std::string>{"one", "", "two", "three"}));
  EXPECT_EQ(ended, (std::vector<bool>{true, true, true, false}));
  EXPECT_EQ(lines.line_number(), 4);
}

TEST(LineReader, LongLinesAndPackedMembersOneAfterTheOther) {
  const test::TempFolder folder;
  const std::string line(300000, 'y');
  write_file(folder / "a.gz", line + "\n");
  write_file(folder / "b.gz", "end\n");
  LineReader lines(folder.put("both.gz", test::slurp(folder / "a.gz") + test::slurp(folder / "b.gz")));
  std::string found;
  ASSERT_TRUE(lines.next(found));
  EXPECT_EQ(found, line);
  ASSERT_TRUE(lines.next(found));
  EXPECT_EQ(found, "end");
  EXPECT_FALSE(lines.next(found));
}

TEST(LineReader, EveryCutOfAPackedFileEndsInAnErrorOrEarlierNeverInRubbish) {
  const test::TempFolder folder;
  std::string content;
  Random random(3);
  for (int i = 0; i < 200; ++i) content += "line " + std::to_string(random.below(1'000'000)) + "\n";
  write_file(folder / "w.gz", content);
  const std::string packed = test::slurp(folder / "w.gz");
  for (std::size_t size = 3; size < packed.size(); size += 7) {
    LineReader lines(folder.put("c.gz", packed.substr(0, size)));
    std::string line, text;
    bool failed = false;
    try {
      while (lines.next(line)) text += line + "\n";
    } catch (const InputError& error) {
      failed = true;
      EXPECT_THAT(error.what(), HasSubstr("c.gz:"));
    }
    EXPECT_TRUE(failed) << size;
    EXPECT_TRUE(content.starts_with(text)) << size;
  }
}

TEST(ReadFile, RefusesMoreThanItsBound) {
  const test::TempFolder folder;
  EXPECT_THROW(read_file(folder.put("big", std::string(200000, 'z')), 100000), InputError);
}

TEST(Number, ReadsBackTheSameAndRefusesWhatIsNone) {
  Random random(5);
  for (int i = 0; i < 1000; ++i) {
    const double value = std::ldexp(random.uniform(-1, 1), static_cast<int>(random.below(200)) - 100);
    std::string text;
    append_number(text, value);
    EXPECT_EQ(parse_number<double>(text), value) << text;
  }
  for (const char* text : {"", " 1", "1 ", "1x", "--1", "+-1", "0x10", "1e", "1e999"})
    EXPECT_FALSE(parse_number<double>(text)) << text;
  EXPECT_EQ(parse_number<double>("+2.5"), 2.5);
}

TEST(Number, StampsKeepEveryNanosecond) {
  Random random(6);
  for (int i = 0; i < 1000; ++i) {
    const Stamp stamp = static_cast<Stamp>(random.below(4'599'000'000'000'000'000ULL)) * (i % 2 == 0 ? 1 : -1);
    std::string text;
    append_stamp(text, stamp);
    EXPECT_EQ(parse_stamp(text), stamp) << text;
  }
  EXPECT_EQ(parse_stamp("1700000000.1234567891"), 1'700'000'000'123'456'789);
  EXPECT_EQ(parse_stamp("1.5e3"), 1'500'000'000'000);
  // What is accepted can be subtracted.
  const Stamp latest = *parse_stamp("4599999999.123456789"), earliest = *parse_stamp("-4599999999.123456789");
  EXPECT_GT(latest - earliest, 0);
  for (const char* text : {"", "now", "nan", "inf", "1e300", "1.2.3", "4600000000", "-9e9"})
    EXPECT_FALSE(parse_stamp(text)) << text;
}

}  // namespace
}  // namespace phasescan::file_test
