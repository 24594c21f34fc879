// Files with random damage: every reader answers with what it could read and with InputError, never with anything else.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "core/random.hpp"
#include "config/config.hpp"
#include "phasescan/io/error.hpp"
#include "phasescan/io/log.hpp"
#include "io/pairs.hpp"
#include "io/scan_log.hpp"
#include "support/command.hpp"
#include "support/paths.hpp"
#include "support/temp.hpp"

namespace phasescan::mutated_test {
namespace {

Scan a_scan(int k) {
  std::vector<float> raw;
  for (int i = 0; i < 12; ++i) raw.push_back(i % 4 == 0 ? 0.0F : 0.25F * static_cast<float>(i + k));
  return make_scan(raw, {-1.0, 0.1, 0.15, 6.0});
}

std::string scan_log_text() {
  std::string text;
  for (int k = 0; k < 6; ++k) {
    LogEntry entry;
    entry.scan = a_scan(k);
    entry.odometry = Pose2{0.1 * k, 0, 0};
    text += format_log_line(entry) + "\n";
  }
  return text;
}

std::string carmen_text() {
  std::string text = "PARAM robot_frontlaser_offset 0.1 h 0\n";
  for (int k = 0; k < 3; ++k) {
    text +=
        "FLASER 4 1 2 81.83 3 1 2 0.5 1 2 0.5 100.2 h 1\nODOM 1 2 3 0 0 0 1 h 1\n"
        "RAWLASER1 0 -1.57 3.14 0.5 10 0.01 0 3 1 2 3 0 1.5 h 1\n"
        "ROBOTLASER1 0 -1.57 3.14 0.5 10 0.01 0 3 1 2 3 0 1 0 0 0.5 0 0 0.1 0.2 0.3 0.4 0 1.5 h 1\n"
        "ROBOTLASER1 0 -1.57 3.14 0.5 10 0.01 0 3 1 2 3 1 0 0 0.5 0 0 0.1 0.2 0.3 0.4 1.5 h 1\n";
  }
  return text;
}

std::string pairs_text() {
  std::string text;
  for (int k = 0; k < 4; ++k) {
    ScanPair pair;
    pair.id = std::to_string(k);
    pair.reference = a_scan(k);
    pair.scan = a_scan(k + 1);
    pair.truth = Pose2{0.1, 0.2, 0.3};
    text += format_pair(pair) + "\n";
  }
  return text;
}

std::string mutated(std::string text, std::uint64_t seed) {
  static const std::vector<std::string> kPieces{"1e999",
                                                "-",
                                                "nan",
                                                "null",
                                                "\"",
                                                "{",
                                                "}",
                                                "[",
                                                "]",
                                                ",",
                                                "\n",
                                                " ",
                                                "999999999999999999999",
                                                "FLASER ",
                                                std::string(1, '\0'),
                                                "\xff",
                                                "0",
                                                "\\u",
                                                ":"};
  Random random(seed);
  for (std::uint64_t n = 1 + random.below(4); n > 0 && !text.empty(); --n) {
    const std::size_t at = random.below(text.size());
    switch (random.below(5)) {
      case 0:
        text[at] = static_cast<char>(random.below(256));
        break;
      case 1:
        text.erase(at, 1 + random.below(20));
        break;
      case 2:
        text.insert(at, kPieces[random.below(kPieces.size())]);
        break;
      case 3:
        text.insert(at, text.substr(random.below(text.size()), random.below(30)));
        break;
      default:
        text.resize(at);
        break;
    }
  }
  return text;
}

void expect_sound(const Scan& scan) {
  ASSERT_EQ(scan.states.size(), scan.size());
  for (std::size_t i = 0; i < scan.size(); ++i) {
    ASSERT_EQ(scan.is_hit(i), std::isfinite(scan.ranges[i]));
    ASSERT_TRUE(std::isfinite(scan.angle(i)));
  }
  ASSERT_TRUE(scan.intensities.empty() || scan.intensities.size() == scan.size());
  for (const float intensity : scan.intensities) ASSERT_TRUE(std::isfinite(intensity));
}

void read_log(const std::string& path) {
  try {
    const auto reader = open_log(path);
    while (const auto entry = reader->next()) {
      expect_sound(entry->scan);
      ASSERT_TRUE(entry->T_base_laser.is_finite());
      ASSERT_TRUE(!entry->odometry || entry->odometry->is_finite());
    }
    for (const LogRemark& remark : reader->remarks()) ASSERT_FALSE(remark.kind.empty() || remark.text.empty());
  } catch (const InputError&) {
  }
}

TEST(MutatedFiles, LogsEndInEntriesDamagesOrAnInputError) {
  const test::TempFolder folder;
  for (const std::string& text : {scan_log_text(), carmen_text()}) {
    for (std::uint64_t seed = 0; seed < 400; ++seed) read_log(folder.put("l", mutated(text, seed)));
  }
}

TEST(MutatedFiles, SeedsOfTheFuzzTargetsToo) {
  const test::TempFolder folder;
  for (const char* corpus : {"printed", "csv", "lowcost", "mcap", "sqlite"}) {
    for (const auto& seed_file : std::filesystem::directory_iterator(test::source_dir() + "/fuzz/corpus/" + corpus)) {
      const std::string bytes = test::slurp(seed_file.path().string());
      const std::uint64_t seeds = bytes.size() > 4000 ? 10 : 60;
      for (std::uint64_t seed = 0; seed < seeds; ++seed) read_log(folder.put("l", mutated(bytes, seed)));
    }
  }
}

TEST(MutatedFiles, PackedLogsToo) {
  const test::TempFolder folder;
  write_file(folder / "w.gz", scan_log_text());
  std::ifstream file(folder / "w.gz", std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(file), {});
  for (std::uint64_t seed = 0; seed < 150; ++seed) read_log(folder.put("l.gz", mutated(bytes, seed)));
}

TEST(MutatedFiles, PairsEndInPairsOrBadLines) {
  const test::TempFolder folder;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    try {
      PairReader reader(folder.put("p", mutated(pairs_text(), seed)));
      while (const auto line = reader.next()) {
        ASSERT_EQ(line->pair.has_value(), line->error.empty());
        if (line->pair) {
          expect_sound(line->pair->reference);
          expect_sound(line->pair->scan);
        }
      }
    } catch (const InputError&) {
    }
  }
}

TEST(MutatedFiles, ConfigurationsLoadOrNameTheirLine) {
  Config defaults;
  const std::string dump = option_table(defaults).dump();
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    Config config;
    try {
      option_table(config).load_text(mutated(dump, seed), "c.yaml");
      config.match.validate();
    } catch (const InputError& error) {
      EXPECT_GE(error.line(), 1);
    }
  }
}

}  // namespace
}  // namespace phasescan::mutated_test
