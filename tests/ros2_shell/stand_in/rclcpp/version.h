// A stand-in: as humble has it.
#pragma once
#define RCLCPP_VERSION_GTE(major, minor, patch) ((16) > (major))
