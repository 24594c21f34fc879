// Local maps made of keyframes of the graph: which keyframes they hold.
#include "slam/visit_maps.hpp"

#include <gtest/gtest.h>

#include "support/toy_keyframes.hpp"

namespace phasescan::visit_maps_test {
namespace {

TEST(VisitMaps, SurroundingsAreMadeOfWhatIsWithinTheRadius) {
  // The other room is seen from its own keyframes alone.
  const std::vector<Pose2> near = {{0.0, 0.0, 1.5}, {-1.0, 0.5, 1.5}, {-0.5, -1.0, 2.0}};
  std::vector<Pose2> all = near;
  for (const Pose2& far : {Pose2{6.0, 0.0, 0.0}, Pose2{6.5, 0.5, 3.0}}) all.push_back(far);
  const auto surroundings = [](const std::vector<Pose2>& poses, double radius_m) {
    Random random(5);
    GraphSession session((LoopOptions()));
    for (Keyframe& keyframe : testing::toy_keyframes(testing::two_rooms(), poses, random))
      session.insert_node(std::move(keyframe));
    LocalMap map;
    build_surroundings(session, 0, radius_m, 10, {}, map);
    return map;
  };
  const LocalMap found = surroundings(all, 3.0), expected = surroundings(near, 3.0), wide = surroundings(all, 8.0);
  EXPECT_EQ(found.surfels().size(), expected.surfels().size());
  EXPECT_GT(wide.surfels().size(), found.surfels().size()) << "the radius is what leaves them out";
}

}  // namespace
}  // namespace phasescan::visit_maps_test
