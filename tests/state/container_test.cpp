// The file around a state: sections with checksums, whole or refused.
#include "state/container.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <system_error>

#include "state/fields.hpp"
#include "support/sealed_state.hpp"
#include "support/temp.hpp"

namespace phasescan::container_test {
namespace {

using ::testing::HasSubstr;

StateSections some_sections() {
  StateSections out;
  std::string zeros(100'000, '\0');  // nearly: what packs beyond all bounds is not packed
  for (std::size_t i = 0; i < zeros.size(); i += 40) zeros[i] = static_cast<char>(i * i >> 9);
  out.sections = {{"empty", ""}, {"zeros", zeros}, {"text", "what is short is not packed"}};
  std::string steps;
  for (int i = 0; i < 5000; ++i) steps += static_cast<char>(i * i >> 4);
  out.sections.push_back({"sixteen letters.", steps});
  return out;
}

std::string refusal_of(const std::string& bytes) {
  try {
    unpack_state(bytes);
    return {};
  } catch (const StateFormatError& error) {
    return error.what();
  }
}

TEST(StateContainer, SectionsComeBack) {
  const StateSections written = some_sections();
  const std::string bytes = pack_state(written);
  EXPECT_TRUE(looks_like_state(bytes));
  const StateSections read = unpack_state(bytes);
  EXPECT_EQ(read.version, kStateFileVersion);
  ASSERT_EQ(read.sections.size(), written.sections.size());
  for (std::size_t i = 0; i < read.sections.size(); ++i) {
    EXPECT_EQ(read.sections[i].name, written.sections[i].name);
    EXPECT_EQ(read.sections[i].content, written.sections[i].content);
  }
  EXPECT_EQ(read.find("none"), nullptr);
  EXPECT_THROW(read.at("none"), StateFormatError);
  EXPECT_EQ(pack_state(read), bytes);
  const std::string plain = testing::unpacked_file(bytes);
  EXPECT_EQ(unpack_state(plain).at("zeros"), written.at("zeros"));
  EXPECT_GT(plain.size(), 100'000u);
}

TEST(StateContainer, CutOffAnywhereOrFollowedByMoreItIsRefused) {
  const std::string bytes = pack_state(some_sections());
  for (std::size_t n = 0; n < bytes.size(); n += n < 300 ? 1 : 61) {
    const std::string why = refusal_of(bytes.substr(0, n));
    EXPECT_FALSE(why.empty()) << n;
    if (n == 0) continue;
    EXPECT_THAT(why, HasSubstr("is cut off: it has " + std::to_string(n) + " bytes; expected ")) << n;
  }
  EXPECT_THAT(refusal_of(bytes + "x"), HasSubstr("1 bytes follow its end"));
  EXPECT_THAT(refusal_of(""), HasSubstr("is no saved state"));
  EXPECT_THAT(refusal_of(std::string(100, 'x')), HasSubstr("is no saved state"));
}

TEST(StateContainer, EveryByteIsUnderAChecksum) {
  const std::string bytes = pack_state(some_sections());
  for (std::size_t at = 0; at < bytes.size(); at += at < 300 ? 1 : 61) {
    std::string flipped = bytes;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x04);
    EXPECT_NE(refusal_of(flipped), "") << at;
  }
}

TEST(StateContainer, WhatASectionClaimsToUnpackToIsBounded) {
  const std::string bytes = pack_state(some_sections());
  const std::size_t zeros = testing::kStateHead + testing::kStateEntry;  // its entry
  for (const std::uint64_t claimed : {std::uint64_t{1} << 50, std::uint64_t{99'999}, std::uint64_t{100'001}}) {
    std::string changed = bytes;
    testing::put_state_number(changed, zeros + 32, 8, claimed);
    EXPECT_THAT(refusal_of(testing::sealed(changed)), HasSubstr("section 'zeros'")) << claimed;
  }
  std::string changed = bytes;
  testing::put_state_number(changed, zeros + 16, 4, 2);
  EXPECT_THAT(refusal_of(testing::sealed(changed)), HasSubstr("is packed in no way that is known"));
  changed = bytes;
  testing::put_state_number(changed, 12, 4, 1000);
  EXPECT_THAT(refusal_of(changed), HasSubstr("its head does not match its checksum"));
}

TEST(StateContainer, VersionsFromTheFirstToThisOneAreRead) {
  StateSections sections = some_sections();
  for (std::uint32_t version = 0; version <= kStateFileVersion + 1; ++version) {
    sections.version = version;
    const std::string why = refusal_of(pack_state(sections));
    EXPECT_EQ(why.empty(), version >= 1 && version <= kStateFileVersion) << version << " " << why;
  }
}

TEST(StateContainer, AFileOfAnotherKindIsRefused) {
  constexpr StateFileKind kOther{std::string_view("\x89PSOTHER", 8), 7, 8, "cake", "a file written by a baker"};
  StateSections sections = some_sections();
  for (sections.version = 6; sections.version <= 9; ++sections.version) {
    const std::string bytes = pack_state(sections, kOther);
    EXPECT_EQ(refusal_of(bytes), "is no saved state; expected a file written by --save");
    try {
      EXPECT_EQ(unpack_state(bytes, kOther).at("zeros"), sections.at("zeros"));
      EXPECT_TRUE(sections.version == 7 || sections.version == 8);
    } catch (const StateFormatError& error) {
      EXPECT_EQ(error.what(),
                "is a cake of version " + std::to_string(sections.version) + "; this build reads versions 7 to 8");
    }
  }
  sections.version = kStateFileVersion;
  try {
    unpack_state(pack_state(sections), kOther);
    FAIL() << "read";
  } catch (const StateFormatError& error) {
    EXPECT_STREQ(error.what(), "is no cake; expected a file written by a baker");
  }
}

TEST(StateContainer, AFileIsReplacedWholeOrNotAtAll) {
  const test::TempFolder folder;
  const std::string path = folder / "a.state";
  replace_file(path, "first");
  replace_file(path, "second");
  EXPECT_EQ(read_bytes(path), "second");
  EXPECT_THROW(replace_file(folder / "none/a.state", "x"), std::system_error);
  EXPECT_THROW(replace_file(folder.path(), "x"), std::system_error);
  EXPECT_THROW(read_bytes(folder / "none"), std::system_error);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

/// A pipe stands for a device here: a file put in its place would take the device from the machine.
TEST(StateContainer, ADeviceIsWrittenToAndNeverReplaced) {
  const test::TempFolder folder;
  const std::string pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  ASSERT_GE(reader, 0);
  replace_file(pipe, "bytes");
  char got[16] = {};
  EXPECT_EQ(::read(reader, got, sizeof got), 5);
  EXPECT_STREQ(got, "bytes");
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  ::close(reader);
}

TEST(StateContainer, ALinkStaysOneAndItsFileIsReplaced) {
  const test::TempFolder folder;
  const std::string file = folder / "a.state", link = folder / "latest.state";
  replace_file(file, "first");
  std::filesystem::create_symlink("a.state", link);
  replace_file(link, "second");
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  EXPECT_EQ(read_bytes(file), "second");
}

/// The name of the file beside it is nobody's concern.
TEST(StateContainer, ARefusalNamesTheFileThatWasAskedFor) {
  const test::TempFolder folder;
  try {
    replace_file(folder / "none/a.state", "x");
    FAIL() << "written";
  } catch (const std::system_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("none/a.state: "));
  }
}

}  // namespace
}  // namespace phasescan::container_test
