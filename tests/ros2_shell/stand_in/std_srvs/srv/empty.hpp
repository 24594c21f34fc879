// A stand-in.
#pragma once
namespace std_srvs::srv {
struct Empty {
  struct Request {};
  struct Response {};
};
}  // namespace std_srvs::srv
