#include "output/map_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "phasescan/io/error.hpp"
#include "io/file.hpp"
#include "support/paths.hpp"

namespace phasescan::map_file_test {
namespace {

class MapFile : public ::testing::Test {
 protected:
  MapFile() : folder_(std::filesystem::temp_directory_path() / ("phasescan_map_" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
    map_.width = 3;
    map_.height = 2;
    map_.resolution_m = 0.05;
    map_.origin = {-1.25, 2.5, 0.0};
    map_.cells = {CellState::kFree,    CellState::kOccupied, CellState::kUnknown,
                  CellState::kUnknown, CellState::kFree,     CellState::kFree};
  }
  ~MapFile() override { std::filesystem::remove_all(folder_); }
  std::string put(const std::string& name, const std::string& text) {
    write_file((folder_ / name).string(), text);
    return (folder_ / name).string();
  }
  std::filesystem::path folder_;
  TrinaryMap map_;
};

TEST_F(MapFile, PixelsAreMapServersAndRowZeroIsTheTop) {
  const std::string pgm = format_pgm(map_);
  const std::string body = pgm.substr(pgm.size() - 6);
  EXPECT_EQ(pgm.substr(0, pgm.size() - 6), "P5\n3 2\n255\n");
  EXPECT_EQ(body, std::string("\xCD\xFE\xFE\xFE\x00\xCD", 6));
}

TEST_F(MapFile, RoundTripThroughPgmAndPng) {
  for (const bool png : {false, true}) {
    put(png ? "m.png" : "m.pgm", png ? format_png(map_) : format_pgm(map_));
    const std::string yaml = put("m.yaml", format_map_yaml(map_, png ? "m.png" : "m.pgm"));
    bool trap = true;
    const TrinaryMap back = read_map(yaml, &trap);
    EXPECT_EQ(back.width, map_.width);
    EXPECT_EQ(back.height, map_.height);
    EXPECT_DOUBLE_EQ(back.resolution_m, map_.resolution_m);
    EXPECT_DOUBLE_EQ(back.origin.x, map_.origin.x);
    EXPECT_DOUBLE_EQ(back.origin.y, map_.origin.y);
    EXPECT_EQ(back.cells, map_.cells);
    EXPECT_FALSE(trap);
  }
}

TEST_F(MapFile, AFreeThresholdOfAQuarterReadsUnknownAsFree) {
  put("m.pgm", format_pgm(map_));
  const std::string head = "image: m.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\n";
  bool trap = false;
  const TrinaryMap quarter = read_map(put("q.yaml", head + "free_thresh: 0.25\n"), &trap);
  EXPECT_TRUE(trap);
  EXPECT_EQ(quarter.cells[2], CellState::kFree);
  const TrinaryMap fine = read_map(put("f.yaml", head + "free_thresh: 0.196\n"), &trap);
  EXPECT_FALSE(trap);
  EXPECT_EQ(fine.cells[2], CellState::kUnknown);
}

TEST_F(MapFile, NegateAndPlainPgm) {
  put("p.pgm", "P2\n# made by hand\n3 1\n255\n0 254 205\n");
  const std::string yaml =
      "image: p.pgm\nresolution: 0.1\norigin: [0, 0, 0]\noccupied_thresh: 0.65\nfree_thresh: 0.196\nnegate: ";
  const TrinaryMap plain = read_map(put("p.yaml", yaml + "0\n"));
  EXPECT_EQ(plain.cells, (std::vector<CellState>{CellState::kOccupied, CellState::kFree, CellState::kUnknown}));
  const TrinaryMap negated = read_map(put("n.yaml", yaml + "true\n"));
  EXPECT_EQ(negated.cells, (std::vector<CellState>{CellState::kFree, CellState::kOccupied, CellState::kOccupied}));
}

TEST_F(MapFile, ScaleAndRawModes) {
  const std::string head =
      "resolution: 0.1\norigin: [1, 2, 0.5]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
  put("r.pgm", std::string("P5\n5 1\n255\n") + std::string("\x00\x64\x13\x32\xFF", 5));
  const TrinaryMap raw = read_map(put("r.yaml", head + "image: r.pgm\nmode: raw\n"));
  EXPECT_EQ(raw.cells, (std::vector<CellState>{CellState::kFree, CellState::kOccupied, CellState::kFree,
                                               CellState::kUnknown, CellState::kUnknown}));
  EXPECT_DOUBLE_EQ(raw.origin.theta, 0.5);
  // Grey and alpha: opaque black, transparent white.
  const std::string png("\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR\x00\x00\x00\x02\x00\x00\x00\x01\x08\x04\x00\x00\x00", 26);
  const std::string seed = read_file(test::source_dir() + "/fuzz/corpus/map/png-alpha");
  EXPECT_EQ(seed.substr(0, 26), png);
  put("a.png", seed);
  const TrinaryMap scale = read_map(put("a.yaml", head + "image: a.png\nmode: scale\n"));
  EXPECT_EQ(scale.cells, (std::vector<CellState>{CellState::kOccupied, CellState::kUnknown}));
  EXPECT_THROW(read_map(put("x.yaml", head + "image: a.png\nmode: colour\n")), InputError);
}

/// Refused by the header: a file of a few bytes that claims 900 million pixels, and a real one, whose body is never
/// read.
TEST_F(MapFile, PicturesLargerThanAnyMapAreRefusedUnread) {
  const std::string head = "resolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
  put("m.pgm", "P5\n30000 30000\n255\n");
  std::filesystem::resize_file(folder_ / "m.pgm", 900'000'018);  // a hole: takes no room on the disk
  for (const char* image : {"m.pgm", "png-too-large"}) {
    const std::string path =
        image == std::string("m.pgm") ? (folder_ / image).string() : test::source_dir() + "/fuzz/corpus/map/" + image;
    try {
      read_map(put("big.yaml", head + "image: " + path + "\n"));
      ADD_FAILURE() << image;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("30000 x 30000"), std::string::npos) << error.what();
    }
  }
}

TEST_F(MapFile, BadFilesAreRefusedWithAReason) {
  put("short.pgm", "P5\n10 10\n255\nabc");
  put("huge.pgm", "P5\n99999999 99999999\n255\n");
  put("text.pgm", "hello");
  const auto yaml = [&](const std::string& image) {
    return "image: " + image +
           "\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
  };
  for (const std::string& text :
       {yaml("short.pgm"), yaml("huge.pgm"), yaml("text.pgm"), yaml("none.pgm"), std::string("image: short.pgm\n"),
        std::string("[1, 2"),
        std::string("resolution: x\nimage: a\norigin: [0,0,0]\noccupied_thresh: 0.65\nfree_thresh: 0.1\n"),
        std::string("")}) {
    EXPECT_THROW(read_map(put("bad.yaml", text)), InputError) << text;
  }
}

}  // namespace
}  // namespace phasescan::map_file_test
