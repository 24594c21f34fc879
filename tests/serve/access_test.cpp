// Who is let in, and which names may become files.
#include <gtest/gtest.h>

#include "serve/access.hpp"
#include "serve/live_control.hpp"
#include "serve/router.hpp"
#include "serve/server.hpp"

namespace phasescan::serve::access_test {
namespace {

const AccessRules kLoopback{"", {"localhost", "robot", "robot.local"}};
const AccessRules kWithToken{"00112233445566778899aabbccddeeff", {"localhost", "robot"}};

Access from(const AccessRules& rules, std::string_view host, std::string_view origin = "", std::string_view token = "",
            std::string_view authorization = "", bool foreign = false) {
  return check_access(rules, {host, origin, token, authorization, foreign});
}

TEST(Access, OnlyAddressesAndOwnNamesAreAnswered) {
  for (const char* host :
       {"127.0.0.1:8080", "localhost:8080", "LOCALHOST", "[::1]:8080", "192.168.1.7:80", "robot.local"})
    EXPECT_EQ(from(kLoopback, host), Access::kGranted) << host;
  // A name that an attacker's DNS leads to this computer.
  for (const char* host : {"evil.example:8080", "localhost.evil.example", "", "127.0.0.1:8080:80", "127.0.0.1:port",
                           "[::1", "[::1]x", "robot@evil", "localhost:", "0x7f.1", "127.0.0.1.evil.example"})
    EXPECT_EQ(from(kLoopback, host), Access::kWrongHost) << host;
}

TEST(Access, PagesOfOthersAreNotLetIn) {
  EXPECT_EQ(from(kLoopback, "localhost:8080", "http://localhost:8080"), Access::kGranted);
  EXPECT_EQ(from(kLoopback, "localhost:8080", "https://localhost:8080"), Access::kGranted);
  for (const char* origin :
       {"http://evil.example", "null", "file://", "http://localhost:8081", "http://localhost:8080.evil.example",
        "http://127.0.0.1:8080", "localhost:8080", "http://localhost:8080/"})
    EXPECT_EQ(from(kLoopback, "localhost:8080", origin), Access::kWrongOrigin) << origin;
  EXPECT_EQ(from(kLoopback, "localhost:8080", "https://app.foxglove.dev", "", "", true), Access::kGranted);
}

TEST(Access, ElsewhereTheTokenIsNeeded) {
  EXPECT_EQ(from(kWithToken, "10.0.0.2:8080"), Access::kNoToken);
  EXPECT_EQ(from(kWithToken, "10.0.0.2:8080", "", "00112233445566778899aabbccddeefe"), Access::kNoToken);
  EXPECT_EQ(from(kWithToken, "10.0.0.2:8080", "", "00112233445566778899aabbccddeeff0"), Access::kNoToken);
  EXPECT_EQ(from(kWithToken, "10.0.0.2:8080", "", kWithToken.token), Access::kGranted);
  EXPECT_EQ(from(kWithToken, "10.0.0.2:8080", "", "", "Bearer " + kWithToken.token), Access::kGranted);
  EXPECT_EQ(from(kWithToken, "10.0.0.2:8080", "", "", "Basic " + kWithToken.token), Access::kNoToken);
  // Who knows the token may come from any page, but by no foreign name.
  EXPECT_EQ(from(kWithToken, "10.0.0.2:8080", "https://app.example", kWithToken.token), Access::kGranted);
  EXPECT_EQ(from(kWithToken, "evil.example", "", kWithToken.token), Access::kWrongHost);
  EXPECT_EQ(from(kWithToken, "10.0.0.2:8080", "https://app.foxglove.dev", "", "", true), Access::kNoToken);
}

TEST(Access, SecretsAreComparedWhole) {
  EXPECT_TRUE(same_secret("abc", "abc"));
  for (const char* other : {"", "ab", "abd", "xbc", "abcabc"}) EXPECT_FALSE(same_secret("abc", other)) << other;
  EXPECT_FALSE(same_secret("", "a"));
  EXPECT_NE(random_token(), random_token());
  EXPECT_EQ(random_token().size(), 32U);
}

TEST(Access, LoopbackIsThisComputerAlone) {
  for (const char* address : {"127.0.0.1", "127.8.8.8", "::1", "localhost"})
    EXPECT_TRUE(is_loopback(address)) << address;
  for (const char* address : {"0.0.0.0", "::", "10.0.0.1", "127.0.0.1.example", "2130706433"})
    EXPECT_FALSE(is_loopback(address)) << address;
}

TEST(Access, OthersAreToldANameThatIsAnswered) {
  const std::string address = address_of_this_computer();
  EXPECT_FALSE(is_loopback(address));
  EXPECT_EQ(from({"", names_of_this_computer()}, address + ":8080"), Access::kGranted) << address;
}

TEST(SaveNames, NothingLeadsOutOfTheFolder) {
  std::string why;
  for (const char* name : {"map", "flat-2.1", "A_b", "2026-01-01"}) EXPECT_TRUE(check_save_name(name, why)) << name;
  for (const std::string name : {"", "..", ".hidden", "a/b", "../x", "a\\b", "-rf", "a b", "c:",
                                 std::string("a\0b", 3).c_str() + 0, "caf\xC3\xA9", std::string(65, 'a').c_str()}) {
    if (name == "a") continue;
    EXPECT_FALSE(check_save_name(name, why)) << name;
  }
  EXPECT_FALSE(check_save_name(std::string("a\0b", 3), why));
  EXPECT_FALSE(why.empty());
}

TEST(Targets, ArePathsAndNothingElse) {
  Target target;
  ASSERT_TRUE(parse_target("/api/status?token=a%20b&x&token=c#part", target));
  EXPECT_EQ(target.path, "/api/status");
  EXPECT_EQ(target.query["token"], "a b");
  EXPECT_EQ(target.query.count("x"), 1U);
  for (const char* text : {"", "*", "http://host/", "/a%", "/a%2", "/a%zz", "/a%00", "/a\nb", "/?a=%0d%0aX"})
    EXPECT_FALSE(parse_target(text, target)) << text;
}

TEST(Targets, NoPathReachesTheFileSystem) {
  Router router;
  router.add_page("/", [](const Target&) { return Answer{200, "text/html", "page", {}}; });
  for (const char* text :
       {"/etc/passwd", "/../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "//", "/.", "/index.html"}) {
    Target target;
    ASSERT_TRUE(parse_target(text, target));
    EXPECT_EQ(answer(router, "GET", target).status, 404) << text;
  }
  EXPECT_EQ(answer(router, "GET", {"/", {}}).status, 200);
  EXPECT_EQ(answer(router, "POST", {"/", {}}).status, 405);
  EXPECT_EQ(answer(router, "DELETE", {"/", {}}).status, 405);
}

TEST(Addresses, AreReadInTheUsualForms) {
  using Where = std::pair<std::string, std::uint16_t>;
  EXPECT_EQ(parse_address("0.0.0.0:9000"), Where("0.0.0.0", 9000));
  EXPECT_EQ(parse_address("9000"), Where("127.0.0.1", 9000));
  EXPECT_EQ(parse_address(":9000"), Where("127.0.0.1", 9000));
  EXPECT_EQ(parse_address("[::1]:9000"), Where("::1", 9000));
  EXPECT_EQ(parse_address("10.0.0.1"), Where("10.0.0.1", 8080));
  for (const char* text : {"", "1.2.3.4:70000", "1.2.3.4:x", "1.2.3.4:-1", "99999"})
    EXPECT_THROW(parse_address(text), std::invalid_argument) << text;
}

}  // namespace
}  // namespace phasescan::serve::access_test
