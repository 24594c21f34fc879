// The tie that nav2's lifecycle manager makes to each of its nodes: without it, it takes a node for dead.
#include <gtest/gtest.h>

#include <bondcpp/bond.hpp>

#include "node_process.hpp"
#include "tester.hpp"

namespace phasescan_ros::test::bond_test {
namespace {

TEST(BondOfANode, FormsWhenItIsActiveAndBreaksWhenItIsKilled) {
  Tester tester("amcl");
  NodeProcess process(PHASESCAN_LOCALIZATION_NODE, "amcl", {});
  ASSERT_TRUE(tester.bring_up());
  bool formed = false, broken = false;
  bond::Bond tie("bond", "amcl", tester.node().shared_from_this());
  tie.setFormedCallback([&] { formed = true; });
  tie.setBrokenCallback([&] { broken = true; });
  tie.setHeartbeatPeriod(0.10);
  tie.setHeartbeatTimeout(4.0);  // as nav2 has it
  tie.start();
  EXPECT_TRUE(tester.wait([&] { return formed; }, 10.0));
  tester.pass(5.0);
  EXPECT_FALSE(broken);
  process.kill();
  EXPECT_TRUE(tester.wait([&] { return broken; }, 10.0));
}

}  // namespace
}  // namespace phasescan_ros::test::bond_test
