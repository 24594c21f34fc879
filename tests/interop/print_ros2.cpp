// Prints a line for each of some messages of every type: type, bytes in hexadecimal; and one with its definition in
// base16. For check_ros2.mjs.
#include <cstdio>
#include <string>

#include "ros2/codec.hpp"
#include "ros2/node_support.hpp"
#include "ros2/type_hash.hpp"

namespace {

std::string hex(std::span<const std::uint8_t> bytes) {
  std::string out;
  for (const std::uint8_t byte : bytes) {
    char text[3];
    std::snprintf(text, sizeof(text), "%02x", byte);
    out += text;
  }
  return out;
}

}  // namespace

int main() {
  using namespace phasescan::ros2;
  for_each_topic_type([]<class M>() {
    const std::string type(Message<M>::type);
    const std::string text = definition<M>();
    std::printf("definition %s %s\n", type.c_str(),
                hex({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}).c_str());
    std::printf("hash %s %s\n", type.c_str(), std::string(type_hash(type)).c_str());
    for (std::uint64_t seed = 1; seed <= 10; ++seed)
      std::printf("message %s %s\n", type.c_str(), hex(encode(random_message<M>(seed))).c_str());
  });
  return 0;
}
