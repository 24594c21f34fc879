// What `slam` writes of glass: its colour in map.png, the legend, the summary, and cells that a robot keeps away from.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "output/map_file.hpp"
#include "io/tum.hpp"
#include "support/command.hpp"

namespace phasescan::slam_glass_test {
namespace {

using nlohmann::json;
using test::run_command;
using test::slurp;
using test::TempFolder;
using ::testing::HasSubstr;

/// Two rooms; between them a glass wall (x = 4, y = 1.6..3.6) and a door that the robot drives through.
constexpr const char* kWorld = R"(
walls:
  - {points: [[0, 0], [8, 0], [8, 5], [0, 5]], closed: false}
  - {points: [[0, 5], [0, 0]]}
  - {points: [[4, 0], [4, 0.3]]}
  - {points: [[4, 1.2], [4, 1.6]]}
  - {points: [[4, 1.6], [4, 3.6]], material: MATERIAL}
  - {points: [[4, 3.6], [4, 5]]}
  - {points: [[6, 4.4], [7, 4.4], [7, 4.9], [6, 4.9]], closed: true}
  - {points: [[0.1, 3.9], [0.7, 3.9], [0.7, 4.9], [0.1, 4.9]], closed: true}
doors:
  - [[4, 0.3], [4, 1.2]]
)";
constexpr const char* kWay =
    "points: [[1, 3], [1.2, 0.8], [2.8, 0.75], [5.2, 0.75], [5.4, 3.6], [6.8, 2], [5.3, 0.75], [2.7, 0.75], [2.8, 4], [1, 3]]\n";

void simulate(const TempFolder& folder, const std::string& material) {
  std::string world = kWorld;
  world.replace(world.find("MATERIAL"), 8, material);
  const auto made =
      run_command({"simulate", "--world", folder.put("w.yaml", world), "--path", folder.put("way.yaml", kWay),
                   "--sensor", "rplidar-a1", "--out", folder / "run.jsonl"});
  ASSERT_EQ(made.code, 0) << made.err;
}

json slam(const TempFolder& folder, const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments = {"slam", folder / "run.jsonl", "--out", folder / "out"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const auto run = run_command(arguments);
  EXPECT_EQ(run.code, 0) << run.err;
  return json::parse(slurp(folder / "out/summary.json"))["glass"];
}

/// Pixels of map.png that are not grey.
std::size_t coloured_pixels(const std::string& data) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_TRUE(png_image_begin_read_from_memory(&image, data.data(), data.size()));
  image.format = PNG_FORMAT_RGB;
  std::vector<unsigned char> rgb(PNG_IMAGE_SIZE(image));
  EXPECT_TRUE(png_image_finish_read(&image, nullptr, rgb.data(), 0, nullptr));
  std::size_t count = 0;
  for (std::size_t i = 0; i < rgb.size(); i += 3) count += rgb[i] != rgb[i + 1] || rgb[i] != rgb[i + 2];
  return count;
}

/// Share of points along the true pane that are occupied within 10 cm, and of the robot's places that are.
std::pair<double, double> occupied_shares(const TempFolder& folder) {
  const TrinaryMap map = read_map(folder / "out/map.yaml");
  const auto truth = read_tum(folder / "run.jsonl.truth.tum");
  const auto found = read_tum(folder / "out/trajectory.tum");
  const auto near = [&](const Eigen::Vector2d& on_map, int cells) {
    const Eigen::Vector2d p = map.origin.inverse() * on_map;
    const int i = static_cast<int>(std::floor(p.x() / map.resolution_m)),
              k = static_cast<int>(std::floor(p.y() / map.resolution_m));
    for (int di = -cells; di <= cells; ++di)
      for (int dk = -cells; dk <= cells; ++dk)
        if (map.at(i + di, k + dk) == CellState::kOccupied) return true;
    return false;
  };
  const Pose2 T_map_world = found.front().pose * truth.front().pose.inverse();
  int pane = 0, way = 0;
  for (int s = 0; s <= 40; ++s) pane += near(T_map_world * Eigen::Vector2d(4.0, 1.6 + 0.05 * s), 2);
  for (const StampedPose& p : found) way += near(p.pose.translation(), 0);
  return {pane / 41.0, way / static_cast<double>(found.size())};
}

TEST(SlamGlass, IsListedDrawnAndKeptAwayFrom) {
  const TempFolder folder;
  simulate(folder, "glass");
  const json glass = slam(folder);
  EXPECT_EQ(glass["count"], 1) << glass;
  EXPECT_NEAR(glass["total_m"], 2.0, 0.4) << glass;
  EXPECT_TRUE(glass["occupied_in_map"]);
  EXPECT_GT(coloured_pixels(slurp(folder / "out/map.png")), 25u);
  EXPECT_THAT(slurp(folder / "out/report.html"), HasSubstr("Light blue, glass: 1 ("));
  const auto [pane, way] = occupied_shares(folder);
  EXPECT_GT(pane, 0.8);
  EXPECT_EQ(way, 0.0);

  // Left out of the map where asked for, still listed and drawn; not looked for at all.
  const json listed = slam(folder, {"--config", folder.put("c.yaml", "glass:\n  block: false\n")});
  EXPECT_EQ(listed["count"], 1);
  EXPECT_FALSE(listed["occupied_in_map"]);
  EXPECT_LT(occupied_shares(folder).first, pane);
  EXPECT_EQ(slam(folder, {"--config", folder.put("d.yaml", "glass:\n  enabled: false\n")})["panes"].size(), 0u);
  EXPECT_EQ(coloured_pixels(slurp(folder / "out/map.png")), 0u);
}

TEST(SlamGlass, NothingIsClaimedInAWorldWithout) {
  const TempFolder folder;
  simulate(folder, "matt");
  EXPECT_EQ(slam(folder)["panes"].size(), 0u);
  EXPECT_EQ(coloured_pixels(slurp(folder / "out/map.png")), 0u);
}

}  // namespace
}  // namespace phasescan::slam_glass_test
