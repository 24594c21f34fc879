// The server with real sockets: what is answered, what is refused, and that nobody pays for a client but itself.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <mutex>
#include <thread>

#include "phasescan/io/error.hpp"
#include "serve/raw_client.hpp"
#include "serve/server.hpp"

namespace phasescan::serve::server_test {
namespace {

using test::RawClient;
using ::testing::HasSubstr;

/// Says what it is told, and keeps who is there.
class Echo final : public WebSocketEndpoint {
 public:
  std::vector<std::string> subprotocols() const override { return protocols; }
  bool allows_origin(std::string_view origin) const override { return origin == "https://friend.example"; }
  std::size_t most_message_bytes() const override { return 1000; }
  void on_open(const std::shared_ptr<Peer>& peer, const std::string& subprotocol) override {
    const std::lock_guard lock(mutex);
    peers.push_back(peer);
    last_protocol = subprotocol;
  }
  void on_message(const std::shared_ptr<Peer>& peer, std::string_view message, bool binary) override {
    if (message == "bye") return peer->close(1000, "as you wish");
    peer->send(std::make_shared<const std::string>(message), binary);
  }
  void on_close(const std::shared_ptr<Peer>& peer) override {
    const std::lock_guard lock(mutex);
    std::erase(peers, peer);
    ++closed;
  }
  void send_all(const SharedBytes& bytes) {
    std::vector<std::shared_ptr<Peer>> now;
    {
      const std::lock_guard lock(mutex);
      now = peers;
    }
    for (const auto& peer : now) peer->send(bytes, true);
  }
  std::size_t count() {
    const std::lock_guard lock(mutex);
    return peers.size();
  }
  std::vector<std::string> protocols;
  std::mutex mutex;
  std::vector<std::shared_ptr<Peer>> peers;
  std::string last_protocol;
  int closed = 0;
};

template <class Condition>
bool soon(const Condition& condition) {
  for (int i = 0; i < 1000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

class ServerTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!has_server()) GTEST_SKIP() << "this build has no server";
  }
  void begin() {
    Router router;
    router.add_page("/", [](const Target&) { return Answer{200, "text/html; charset=utf-8", "the page", {}}; });
    router.add_endpoint("/ws", echo);
    options.port = 0;
    server = std::make_unique<Server>(options, router);
  }
  ServeOptions options;
  std::shared_ptr<Echo> echo = std::make_shared<Echo>();
  std::unique_ptr<Server> server;
};

TEST_F(ServerTest, AnswersAndRefusesByPathMethodAndHost) {
  begin();
  RawClient client(server->port());
  EXPECT_EQ(client.get("/"), 200);
  EXPECT_THAT(client.last(), HasSubstr("the page"));
  EXPECT_THAT(client.last(), HasSubstr("X-Content-Type-Options: nosniff"));
  EXPECT_EQ(client.get("/etc/passwd"), 404);
  EXPECT_EQ(client.get("/ws"), 426);
  client.send("POST / HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 3\r\n\r\nabc");
  EXPECT_THAT(client.answer(), HasSubstr(" 405 "));
  EXPECT_EQ(RawClient(server->port()).get("/", "evil.example"), 403);
  EXPECT_EQ(RawClient(server->port()).get("/", "127.0.0.1", "Host: 127.0.0.1\r\n"), 403);
  EXPECT_EQ(RawClient(server->port()).get("/", "127.0.0.1", "Origin: http://evil.example\r\n"), 403);
  EXPECT_EQ(RawClient(server->port()).get("http://127.0.0.1/"), 400);
  RawClient old(server->port());
  old.send("GET / HTTP/1.0\r\n\r\n");
  EXPECT_THAT(old.answer(), HasSubstr(" 403 ")) << "no Host at all";
}

TEST_F(ServerTest, HeadHasNoBody) {
  begin();
  RawClient client(server->port());
  client.send("HEAD / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
  const std::string text = client.receive_all();
  EXPECT_THAT(text, HasSubstr("Content-Length: 8"));
  EXPECT_EQ(text.substr(text.size() - 4), "\r\n\r\n");
}

TEST_F(ServerTest, WhatIsTooLargeOrNoHttpIsRefused) {
  begin();
  EXPECT_EQ(RawClient(server->port()).get("/" + std::string(10000, 'a')), 431);
  EXPECT_EQ(RawClient(server->port()).get("/", "127.0.0.1", "X: " + std::string(10000, 'a') + "\r\n"), 431);
  RawClient body(server->port());
  body.send("POST / HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 1000000\r\n\r\n");
  EXPECT_THAT(body.answer(), HasSubstr(" 413 "));
  RawClient garbage(server->port());
  garbage.send("\x16\x03\x01 this is TLS\r\n\r\n");
  EXPECT_THAT(garbage.answer(), HasSubstr(" 400 "));
  EXPECT_EQ(RawClient(server->port()).get("/"), 200);
}

TEST_F(ServerTest, TooManyRequestsOfOneConnectionAreRefused) {
  options.limits.burst = 5.0;
  options.limits.requests_per_s = 0.001;
  begin();
  RawClient client(server->port());
  for (int i = 0; i < 5; ++i) EXPECT_EQ(client.get("/"), 200);
  EXPECT_EQ(client.get("/"), 429);
  client.receive_all();
  EXPECT_TRUE(client.closed());
  EXPECT_EQ(RawClient(server->port()).get("/"), 200);
}

TEST_F(ServerTest, WhoSendsNothingMakesRoom) {
  options.limits.connections = 4;
  begin();
  std::vector<std::unique_ptr<RawClient>> idle;
  for (int i = 0; i < 12; ++i) {
    idle.push_back(std::make_unique<RawClient>(server->port()));
    idle.back()->send("GET / HT");
  }
  EXPECT_EQ(RawClient(server->port()).get("/"), 200);
  EXPECT_LE(server->counts().connections, 5U);
}

TEST_F(ServerTest, ARequestThatNeverEndsIsCutOff) {
  options.limits.request_timeout_s = 0.2;
  begin();
  RawClient client(server->port());
  client.send("GET / HTTP/1.1\r\nHo");
  client.receive_all();
  EXPECT_TRUE(client.closed());
}

TEST_F(ServerTest, WithATokenNothingIsGivenWithoutIt) {
  options.token = "00112233445566778899aabbccddeeff";
  begin();
  EXPECT_THAT(server->url(), HasSubstr("?token=" + options.token));
  EXPECT_EQ(RawClient(server->port()).get("/"), 403);
  EXPECT_EQ(RawClient(server->port()).get("/nothing"), 403) << "who has no token learns of no path";
  EXPECT_EQ(RawClient(server->port()).get("/?token=" + options.token), 200);
  EXPECT_EQ(RawClient(server->port()).get("/", "127.0.0.1", "Authorization: Bearer " + options.token + "\r\n"), 200);
  EXPECT_EQ(RawClient(server->port()).upgrade("/ws"), 403);
  EXPECT_EQ(RawClient(server->port()).upgrade("/ws?token=" + options.token), 101);
}

TEST_F(ServerTest, BoundElsewhereATokenIsMade) {
  options.address = "0.0.0.0";
  begin();
  EXPECT_EQ(RawClient(server->port()).get("/"), 403);
  const std::string url = server->url();
  EXPECT_EQ(RawClient(server->port()).get(url.substr(url.find("/?"))), 200);
}

TEST_F(ServerTest, WebSocketMessagesComeBack) {
  begin();
  RawClient client(server->port());
  ASSERT_EQ(client.upgrade("/ws"), 101);
  EXPECT_THAT(client.last(), HasSubstr("s3pPLMBiTxaQ9kYGzzhZRbK+xOo=")) << "RFC 6455, section 1.3";
  client.send_frame(1, "hello");
  auto frame = client.frame();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->opcode, 1);
  EXPECT_EQ(frame->payload, "hello");
  client.send_frame(2, std::string(900, 'x'));
  frame = client.frame();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->opcode, 2);
  EXPECT_EQ(frame->payload.size(), 900U);
  client.send_frame(1, "bye");
  frame = client.frame();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->opcode, 8);
  EXPECT_EQ(frame->payload.substr(0, 2), std::string("\x03\xE8"));
}

TEST_F(ServerTest, WebSocketsOfOtherPagesAndPathsAreRefused) {
  begin();
  EXPECT_EQ(RawClient(server->port()).upgrade("/ws", "Origin: http://evil.example\r\n"), 403);
  EXPECT_EQ(RawClient(server->port()).upgrade("/ws", "Origin: null\r\n"), 403);
  EXPECT_EQ(RawClient(server->port()).upgrade("/ws", "Origin: http://127.0.0.1\r\n"), 101);
  EXPECT_EQ(RawClient(server->port()).upgrade("/ws", "Origin: https://friend.example\r\n"), 101);
  EXPECT_EQ(RawClient(server->port()).get("/", "127.0.0.1", "Origin: https://friend.example\r\n"), 403)
      << "let in at the endpoint alone";
  EXPECT_EQ(RawClient(server->port()).upgrade("/"), 404);
}

TEST_F(ServerTest, TheBestSubprotocolIsChosen) {
  echo->protocols = {"new.v2", "old.v1"};
  begin();
  RawClient both(server->port());
  ASSERT_EQ(both.upgrade("/ws", "Sec-WebSocket-Protocol: old.v1, new.v2\r\n"), 101);
  EXPECT_THAT(both.last(), HasSubstr("Sec-WebSocket-Protocol: new.v2\r\n"));
  EXPECT_EQ(RawClient(server->port()).upgrade("/ws", "Sec-WebSocket-Protocol: other\r\n"), 400);
  EXPECT_EQ(RawClient(server->port()).upgrade("/ws"), 400);
}

TEST_F(ServerTest, FramesThatBreakTheRulesEndTheConnection) {
  begin();
  const auto code_after = [&](const auto& send) {
    RawClient client(server->port());
    EXPECT_EQ(client.upgrade("/ws"), 101);
    send(client);
    auto frame = client.frame();
    while (frame && frame->opcode == 10) frame = client.frame();  // pongs
    if (!frame || frame->opcode != 8 || frame->payload.size() < 2) return 0;
    return static_cast<unsigned char>(frame->payload[0]) * 256 + static_cast<unsigned char>(frame->payload[1]);
  };
  EXPECT_EQ(code_after([](RawClient& c) { c.send_frame(1, std::string(1001, 'x')); }), 1009) << "too long";
  EXPECT_EQ(code_after([](RawClient& c) { c.send_frame(1, "x", false); }), 1002) << "not masked";
  EXPECT_EQ(code_after([](RawClient& c) { c.send_frame(3, "x"); }), 1002) << "an opcode that is none";
  EXPECT_EQ(code_after([](RawClient& c) { c.send_frame(1, "\xFF\xFE"); }), 1007) << "no UTF-8";
  EXPECT_EQ(code_after([](RawClient& c) {
              for (int i = 0; i < 200; ++i) c.send_frame(9, "", true, true), c.send_frame(1, "x", true, false);
            }),
            1002)
      << "a message within a message";
}

TEST_F(ServerTest, ATorrentOfMessagesIsCutOff) {
  options.limits.burst = 10.0;
  options.limits.requests_per_s = 1.0;
  begin();
  RawClient client(server->port());
  ASSERT_EQ(client.upgrade("/ws"), 101);
  for (int i = 0; i < 50; ++i) client.send_frame(1, "x");
  int messages = 0;
  for (auto frame = client.frame(); frame && frame->opcode == 1; frame = client.frame()) ++messages;
  EXPECT_LE(messages, 12);
}

TEST_F(ServerTest, ASlowClientIsDroppedAndOthersGoOn) {
  options.limits.queue_bytes = 1 << 20;
  begin();
  RawClient slow(server->port(), 4096), quick(server->port());
  ASSERT_EQ(slow.upgrade("/ws"), 101);
  ASSERT_EQ(quick.upgrade("/ws"), 101);
  ASSERT_TRUE(soon([&] { return echo->count() == 2; }));
  const auto bytes = std::make_shared<const std::string>(100000, 'x');
  std::chrono::steady_clock::duration longest{};
  for (int i = 0; i < 150; ++i) {
    const auto before = std::chrono::steady_clock::now();
    echo->send_all(bytes);
    longest = std::max(longest, std::chrono::steady_clock::now() - before);
    const auto frame = quick.frame();
    ASSERT_TRUE(frame) << i;
    ASSERT_EQ(frame->payload.size(), 100000U);
  }
  EXPECT_TRUE(soon([&] { return echo->count() == 1; }));
  EXPECT_EQ(server->counts().dropped, 1U);
}

TEST_F(ServerTest, AClientThatStopsReadingIsDroppedAfterAWhile) {
  options.limits.write_timeout_s = 0.1;
  begin();
  RawClient slow(server->port(), 4096);
  ASSERT_EQ(slow.upgrade("/ws"), 101);
  ASSERT_TRUE(soon([&] { return echo->count() == 1; }));
  echo->send_all(std::make_shared<const std::string>(4000000, 'x'));
  EXPECT_TRUE(soon([&] { return echo->count() == 0; }));
}

TEST_F(ServerTest, AClientThatEndsItsSideAndReadsNothingHoldsNoPlace) {
  begin();
  RawClient half(server->port(), 4096);
  ASSERT_EQ(half.upgrade("/ws"), 101);
  ASSERT_TRUE(soon([&] { return echo->count() == 1; }));
  echo->send_all(std::make_shared<const std::string>(4000000, 'x'));
  echo->send_all(std::make_shared<const std::string>(1000, 'x'));
  half.end_sending();  // while a message is on its way that it never takes
  EXPECT_TRUE(soon([&] { return echo->count() == 0; }));
  EXPECT_TRUE(soon([&] { return server->counts().web_sockets == 0; }));
}

TEST_F(ServerTest, AConnectionThatIsEndedTwiceEnds) {
  begin();
  {
    RawClient client(server->port());
    ASSERT_EQ(client.upgrade("/ws"), 101);
    ASSERT_TRUE(soon([&] { return echo->count() == 1; }));
    std::shared_ptr<Peer> peer;
    {
      const std::lock_guard lock(echo->mutex);
      peer = echo->peers.front();
    }
    for (int i = 0; i < 4; ++i) peer->close(1000, "as you wish");
    const auto frame = client.frame();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->opcode, 8);
    client.send_frame(8, "\x03\xe8");
  }
  EXPECT_TRUE(soon([&] { return echo->count() == 0; }));
  EXPECT_TRUE(soon([&] { return server->counts().web_sockets == 0; }));
}

TEST_F(ServerTest, ItEndsWithClientsStillThere) {
  begin();
  RawClient idle(server->port()), half(server->port()), socket(server->port());
  half.send("GET / HTTP");
  ASSERT_EQ(socket.upgrade("/ws"), 101);
  ASSERT_TRUE(soon([&] { return echo->count() == 1; }));
  server.reset();
  EXPECT_EQ(echo->closed, 1);
}

TEST_F(ServerTest, APortThatIsTakenIsSaid) {
  begin();
  ServeOptions again;
  again.port = server->port();
  EXPECT_THROW(Server(again, Router()), SystemError);
  again.address = "nowhere";
  EXPECT_THROW(Server(again, Router()), std::invalid_argument);
}

}  // namespace
}  // namespace phasescan::serve::server_test
