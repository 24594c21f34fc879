// Prepared maps that are kept: the same map again, or a reason why not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <system_error>
#include <thread>

#include "localize/map_data.hpp"
#include "localize/prepared_file.hpp"
#include "phasescan/localize/localizer.hpp"
#include "phasescan/slam/state.hpp"
#include "support/sealed_state.hpp"
#include "support/temp.hpp"
#include "support/toy_map.hpp"

namespace phasescan::prepared_map_test {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using testing::toy_map;
using testing::two_rooms;

PreparedMap prepared(const TrinaryMap& drawn, const LocalizeOptions& options = {}) {
  return {drawn, LocalizationMap::from_grid(drawn, options)};
}

const TrinaryMap& rooms() {
  static const TrinaryMap map = toy_map(two_rooms(), {0, 0}, 0.05, 0.4);
  return map;
}

const std::string& rooms_kept() {
  static const std::string bytes = encode_prepared(prepared(rooms()), digest_of(rooms()));
  return bytes;
}

std::string refusal_of(const std::string& bytes, const MapDigest& made_of = digest_of(rooms()),
                       const LocalizeOptions& options = {}) {
  try {
    decode_prepared(bytes, made_of, options);
    return {};
  } catch (const PreparedMapError& error) {
    return error.what();
  }
}

/// Every number of the answers to some scans, single and on the way.
std::vector<double> answers_on(const LocalizationMap& map) {
  std::vector<double> out;
  Random random(4);
  Localizer localizer(map);
  for (int n = 0; n < 12; ++n) {
    const Pose2 T_map_base{-1.0 + 0.15 * n, 0.1 * (n % 3), 0.2 * n};
    RangeMeasurement m{testing::toy_scan(two_rooms(), T_map_base, {}, random, stamp_from_seconds(0.2 * n)), "", {}, {}};
    for (const LocalizationUpdate& u : {locate(map, m), localizer.add(m)}) {
      out.push_back(static_cast<double>(u.status));
      out.push_back(u.fit.log_likelihood);
      for (const PoseEstimate& h : u.hypotheses) {
        out.insert(out.end(), {h.T_map_base.x, h.T_map_base.y, h.T_map_base.theta, h.confidence});
        out.insert(out.end(), h.covariance.data(), h.covariance.data() + 9);
      }
    }
  }
  return out;
}

bool same_surfels(const LocalMap& a, const LocalMap& b) {
  const auto same = [](const Surfel& s, const Surfel& t) {
    return s.x == t.x && s.y == t.y && s.nx == t.nx && s.ny == t.ny && s.variance == t.variance &&
           s.normal_variance == t.normal_variance && s.next == t.next && s.free_standing == t.free_standing;
  };
  return std::equal(a.surfels().begin(), a.surfels().end(), b.surfels().begin(), b.surfels().end(), same);
}

TEST(PreparedMap, ComesBackBitForBit) {
  for (const double cell : {0.05, 0.02, 0.1}) {
    const TrinaryMap drawn = toy_map(two_rooms(), {0, 0}, cell, 0.4);
    const PreparedMap made = prepared(drawn);
    const std::string bytes = encode_prepared(made, digest_of(drawn));
    const PreparedMap read = decode_prepared(bytes, digest_of(drawn));
    EXPECT_EQ(digest_of(read.drawn), digest_of(drawn));
    EXPECT_EQ(read.drawn.cells, drawn.cells);
    const LocalizationMap::Data &a = made.map.data(), &b = read.map.data();
    EXPECT_EQ(a.T_map_grid.theta, b.T_map_grid.theta);
    EXPECT_EQ(a.grid.free, b.grid.free);
    EXPECT_EQ(a.grid.occupied, b.grid.occupied);
    EXPECT_EQ(a.grid.distance, b.grid.distance);
    EXPECT_EQ(a.views.x, b.views.x);
    EXPECT_EQ(a.views.y, b.views.y);
    EXPECT_EQ(a.views.bytes, b.views.bytes);
    EXPECT_TRUE(same_surfels(a.coarse, b.coarse));
    EXPECT_TRUE(same_surfels(a.fine, b.fine));
    EXPECT_EQ(a.surface_points, b.surface_points);
    EXPECT_EQ(made.map.free_area_m2(), read.map.free_area_m2());
    EXPECT_EQ(made.map.memory_bytes(), read.map.memory_bytes());
    EXPECT_EQ(answers_on(made.map), answers_on(read.map));
    EXPECT_EQ(encode_prepared(read, digest_of(drawn)), bytes);
  }
}

/// Fails where preparation changed: raise kPreparedVersion (src/localize/prepared_map.cpp), and put the numbers of the
/// new version here.
TEST(PreparedMap, ItsVersionGoesWithWhatIsPrepared) {
  const PreparedMap made = prepared(rooms());
  const LocalizationMap::Data& data = made.map.data();
  const auto bytes_of = [](const std::vector<std::uint8_t>& v) {
    return std::string_view(reinterpret_cast<const char*>(v.data()), v.size());
  };
  const std::uint64_t version = testing::state_number(rooms_kept(), 8, 4);
  EXPECT_EQ(version, kPreparedVersion);
  ASSERT_EQ(version, 1U);
  EXPECT_EQ(digest_of(bytes_of(data.grid.distance)).low, 2086531323338310069ULL) << "of version " << version;
  EXPECT_EQ(digest_of(bytes_of(data.views.bytes)).low, 157318234836734927ULL) << "of version " << version;
  EXPECT_EQ(data.surface_points, 804U) << "of version " << version;
  EXPECT_EQ(data.fine.surfels().size(), 505U) << "of version " << version;
}

TEST(MapDigest, IsThatOfMurmurHash3AndOfEveryNumber) {
  const std::string hello = "hello";
  EXPECT_EQ(digest_of(std::string_view("")), MapDigest{});
  EXPECT_EQ(digest_of(std::string_view(hello)), (MapDigest{0xcbd8a7b341bd9b02ULL, 0x5b1e906a48ae1d19ULL}));
  EXPECT_EQ(digest_of(std::string_view("The quick brown fox jumps over the lazy dog")),
            (MapDigest{0xe34bbc7bbc071b6cULL, 0x7a433ca9c49a9347ULL}));
  const auto differs = [](auto change) {
    TrinaryMap map = rooms();
    change(map);
    EXPECT_NE(digest_of(map), digest_of(rooms()));
  };
  differs([](TrinaryMap& m) { m.resolution_m = 0.0500001; });
  differs([](TrinaryMap& m) { m.origin.x += 1e-9; });
  differs([](TrinaryMap& m) { m.origin.theta = -m.origin.theta; });
  differs([](TrinaryMap& m) { std::swap(m.width, m.height); });
  differs([](TrinaryMap& m) { m.cells.back() = CellState::kOccupied; });
}

TEST(PreparedMap, OfAnotherMapOrOtherOptionsIsRefused) {
  TrinaryMap other = rooms();
  other.cells[other.cells.size() / 2] =
      other.cells[other.cells.size() / 2] == CellState::kFree ? CellState::kUnknown : CellState::kFree;
  EXPECT_EQ(refusal_of(rooms_kept(), digest_of(other)), "is of another map");
  for (const bool spacing : {true, false}) {
    LocalizeOptions options;
    (spacing ? options.view_spacing_m : options.view_range_m) *= 1.5;
    EXPECT_THAT(refusal_of(rooms_kept(), digest_of(rooms()), options), HasSubstr("other options"));
  }
  LocalizeOptions of_searching;
  of_searching.candidates = 10;
  of_searching.min_confidence = 0.5;
  EXPECT_EQ(refusal_of(rooms_kept(), digest_of(rooms()), of_searching), "");
  LocalizeOptions wide;
  wide.view_spacing_m = 0.7;
  const std::string bytes = encode_prepared(prepared(rooms(), wide), digest_of(rooms()));
  EXPECT_EQ(refusal_of(bytes, digest_of(rooms()), wide), "");
  EXPECT_THAT(refusal_of(bytes), HasSubstr("other options"));
}

TEST(PreparedMap, CutOffAnywhereItIsRefused) {
  const std::string& bytes = rooms_kept();
  for (std::size_t n = 0; n < bytes.size(); n += n < 400 ? 1 : 97)
    EXPECT_THAT(refusal_of(bytes.substr(0, n)), AnyOf(HasSubstr("is cut off"), HasSubstr("is no prepared map"))) << n;
  EXPECT_THAT(refusal_of(bytes + "x"), HasSubstr("1 bytes follow its end"));
}

TEST(PreparedMap, AChangedByteIsNoticed) {
  const std::string& bytes = rooms_kept();
  for (std::size_t at = 0; at < bytes.size(); at += at < 400 ? 1 : 97) {
    std::string flipped = bytes;
    flipped[at] = static_cast<char>(flipped[at] ^ (1 << at % 8));
    EXPECT_NE(refusal_of(flipped), "") << at;
  }
}

/// Past the checksums: what is read is a map that can be worked on, or is refused.
TEST(PreparedMap, WhatIsChangedUnderRightChecksumsIsSoundOrRefused) {
  const std::string bytes = testing::unpacked_file(rooms_kept(), kPreparedMap);
  Random random(17);
  RangeMeasurement m{testing::toy_scan(two_rooms(), {0.3, 0.2, 0.5}, {}, random, 0), "", {}, {}};
  int refused = 0, read = 0;
  for (int n = 0; n < 300; ++n) {
    std::string changed = bytes;
    // Heads of sections and lists, where lengths stand, as often as numbers.
    const std::size_t at = n % 2 == 0 ? 16 + random.below(600) : random.below(changed.size());
    for (std::size_t k = at; k < std::min(at + 1 + random.below(8), changed.size()); ++k)
      changed[k] = static_cast<char>(random.below(256));
    try {
      locate(decode_prepared(testing::sealed(changed), digest_of(rooms())).map, m);
      ++read;
    } catch (const PreparedMapError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 30);
  EXPECT_GT(read, 30);
}

TEST(PreparedMap, FilesOfOtherKindsAndVersionsAreRefused) {
  std::string other = rooms_kept();
  testing::put_state_number(other, 8, 4, 2);
  EXPECT_EQ(refusal_of(testing::sealed(other)), "is a prepared map of version 2; this build reads versions 1 to 1");
  testing::put_state_number(other, 8, 4, 0x01000000);  // numbers the other way round
  EXPECT_THAT(refusal_of(testing::sealed(other)), HasSubstr("of version 16777216"));
  EXPECT_THAT(refusal_of("image: map.pgm\nresolution: 0.05\n"), HasSubstr("is no prepared map; expected a file"));
  EXPECT_THAT(refusal_of(""), HasSubstr("is no prepared map"));
  EXPECT_THAT(refusal_of(encode_state({Slam().checkpoint(), {}})), HasSubstr("is no prepared map"));
  EXPECT_FALSE(is_saved_state(rooms_kept()));
  EXPECT_THROW(decode_state(rooms_kept()), StateError);
}

TEST(PreparedMap, WhatCannotBeKeptIsSaidSo) {
  const PreparedMap mistaken{toy_map(two_rooms(), {0, 0}, 0.05, 0.1), prepared(rooms()).map};
  EXPECT_THROW(encode_prepared(mistaken, digest_of(rooms())), std::invalid_argument);
  // A corridor of 2.9 km: the tables of its surfels are a square of that.
  TrinaryMap corridor{58'000, 12, 0.05, {}, {}};
  corridor.cells.assign(58'000 * 12, CellState::kFree);
  for (std::size_t i = 0; i < 58'000; ++i) corridor.cells[i] = CellState::kOccupied;
  for (std::size_t k = 0; k < 12; ++k) corridor.cells[k * 58'000 + 400] = CellState::kOccupied;
  LocalizationMap::Data data;  // with no surfels: they would take gigabytes
  data.grid = make_map_grid(corridor);
  data.views = {{1.0F}, {0.3F}, std::vector<std::uint8_t>(kViewDirections)};
  const PreparedMap thin{corridor, LocalizationMap(std::make_shared<const LocalizationMap::Data>(std::move(data)))};
  EXPECT_THROW(encode_prepared(thin, digest_of(corridor)), PreparedMapError);
}

TEST(PreparedMap, FilesAreReplacedWholeAndRefusalsNameThem) {
  const test::TempFolder folder;
  const std::string path = folder / "map.prepared";
  EXPECT_THROW(load_prepared(path, digest_of(rooms())), std::system_error);
  save_prepared(path, prepared(rooms()), digest_of(rooms()));
  EXPECT_EQ(load_prepared(path, digest_of(rooms())).drawn.cells, rooms().cells);
  EXPECT_THROW(save_prepared(folder / "none/map.prepared", prepared(rooms()), digest_of(rooms())), std::system_error);
  EXPECT_THROW(save_prepared(folder.path(), prepared(rooms()), digest_of(rooms())), std::system_error);
  const std::string pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& none :
       {pipe, folder.path(), folder.put("text", "this is a text, not a map"), folder.put("no", "")}) {
    try {
      load_prepared(none, digest_of(rooms()));
      FAIL() << none;
    } catch (const PreparedMapError& error) {
      EXPECT_THAT(error.what(), HasSubstr(none + ": is no ")) << none;
    }
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 4);
}

/// Whoever reads finds one of the maps, whole.
TEST(PreparedMap, ManyThatWriteAtOnceLeaveAWholeFile) {
  const test::TempFolder folder;
  const std::string path = folder / "map.prepared";
  const PreparedMap map = prepared(rooms());
  save_prepared(path, map, digest_of(rooms()));
  std::vector<pid_t> children;
  for (int c = 0; c < 2; ++c) {
    children.push_back(::fork());
    if (children.back() != 0) continue;
    for (int n = 0; n < 20; ++n) save_prepared(path, map, digest_of(rooms()));
    ::_exit(0);
  }
  std::vector<std::thread> threads;
  for (int t = 0; t < 2; ++t) {
    threads.emplace_back([&] {
      for (int n = 0; n < 20; ++n) save_prepared(path, map, digest_of(rooms()));
    });
  }
  for (int n = 0; n < 40; ++n) EXPECT_NO_THROW(load_prepared(path, digest_of(rooms())));
  for (std::thread& thread : threads) thread.join();
  for (const pid_t child : children) {
    int status = -1;
    ::waitpid(child, &status, 0);
    EXPECT_EQ(status, 0);
  }
  EXPECT_NO_THROW(load_prepared(path, digest_of(rooms())));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

}  // namespace
}  // namespace phasescan::prepared_map_test
