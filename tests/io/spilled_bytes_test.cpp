// Bytes that wait on the disk come back as they were, and leave nothing behind.
#include "io/spilled_bytes.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "support/temp.hpp"

namespace phasescan {
namespace {

std::vector<std::uint8_t> all_of(SpilledBytes& spilled) {
  std::vector<std::uint8_t> out;
  spilled.read([&](Bytes piece) { out.insert(out.end(), piece.begin(), piece.end()); });
  return out;
}

TEST(SpilledBytes, ComeBackInOrderAndLeaveNoFile) {
  const test::TempFolder folder;
  for (const std::string& where : {folder / "", std::string(), folder / "missing"}) {
    SpilledBytes spilled(where);
    std::vector<std::uint8_t> expected;
    for (std::size_t i = 0; i < 3000; ++i) {
      const std::vector<std::uint8_t> bytes(i % 97, static_cast<std::uint8_t>(i * 31));
      spilled.add(bytes);
      expected.insert(expected.end(), bytes.begin(), bytes.end());
    }
    EXPECT_GT(expected.size(), 100000U);
    EXPECT_EQ(spilled.size(), expected.size());
    EXPECT_EQ(all_of(spilled), expected);
    SpilledBytes moved(std::move(spilled));
    moved.add(std::vector<std::uint8_t>{1, 2, 3});
    expected.insert(expected.end(), {1, 2, 3});
    EXPECT_EQ(all_of(moved), expected);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder / ""));
}

}  // namespace
}  // namespace phasescan
