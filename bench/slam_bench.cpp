// SLAM, stage by stage: building a local map, one registration, one tracked scan, the index.
#include <benchmark/benchmark.h>

#include "odometry/tracker.hpp"
#include "slam/place_index.hpp"
#include "support/toy_world.hpp"

namespace {

using namespace phasescan;

/// A tour of the toy world: scans, and the map points of a few of them.
struct Fixture {
  std::vector<Pose2> tour = testing::toy_tour(0.18, 0.4, 1.2);
  std::vector<Scan> scans;
  std::vector<MapPoints> points;

  Fixture() {
    const auto walls = testing::two_rooms();
    Random random(1);
    SurfaceWorkspace work;
    SurfacePoints surface;
    for (std::size_t i = 0; i < tour.size(); ++i) {
      scans.push_back(testing::toy_scan(walls, tour[i], {}, random, stamp_from_seconds(0.18 * static_cast<double>(i))));
      find_surface(scans.back(), {}, work, surface, kTrackingLines);
      points.emplace_back();
      to_map_points(surface, {}, 40.0, points.back());
    }
  }
};

const Fixture& fixture() {
  static const Fixture kFixture;
  return kFixture;
}

void build(LocalMap& map) {
  const Fixture& f = fixture();
  map.reset(f.tour[32], 35.0, 0.1);
  for (std::size_t k = 0; k < 64; k += 4) map.add(f.points[k], f.tour[k]);
  map.finish();
}

void BM_LocalMap(benchmark::State& state) {
  LocalMap map;
  for (auto _ : state) build(map);
}
BENCHMARK(BM_LocalMap)->Unit(benchmark::kMicrosecond);

void BM_Register(benchmark::State& state) {
  const Fixture& f = fixture();
  LocalMap map;
  build(map);
  const Pose2 guess = map.T_world_map().inverse() * f.tour[34] * Pose2{0.08, -0.04, 0.05};
  for (auto _ : state) benchmark::DoNotOptimize(register_points(map, f.points[34], guess));
}
BENCHMARK(BM_Register)->Unit(benchmark::kMicrosecond);

void BM_TrackScan(benchmark::State& state) {
  const Fixture& f = fixture();
  for (auto _ : state) {
    Tracker tracker;
    for (const Scan& scan : f.scans) benchmark::DoNotOptimize(tracker.add({scan}));
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * static_cast<std::int64_t>(f.scans.size()));
}
BENCHMARK(BM_TrackScan)->Unit(benchmark::kMillisecond);

void BM_PlaceIndex(benchmark::State& state) {
  Random random(3);
  PlaceIndex index;
  PlaceDescriptor d;
  for (std::int64_t i = 0; i < state.range(0); ++i) {
    for (auto& v : d.numbers) v = static_cast<std::int8_t>(static_cast<int>(random.below(256)) - 128);
    for (auto& v : d.turning) v = static_cast<std::uint8_t>(random.below(256));
    index.add(d);
  }
  for (auto _ : state) benchmark::DoNotOptimize(index.most_alike(d, 10));
}
BENCHMARK(BM_PlaceIndex)->Arg(1000)->Arg(10000)->Arg(100000)->Unit(benchmark::kMicrosecond);

}  // namespace
