// On a domain of its own, so that no robot nearby takes part.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <rclcpp/rclcpp.hpp>
#include <string>

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  const std::string domain = std::to_string(100 + getpid() % 100);
  setenv("ROS_DOMAIN_ID", domain.c_str(), 0);
  setenv("ROS_LOCALHOST_ONLY", "1", 0);
  rclcpp::init(argc, argv);
  const int result = RUN_ALL_TESTS();
  rclcpp::shutdown();
  return result;
}
