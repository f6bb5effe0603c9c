#include "server/http/connection_places.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "server/http/connection_threads.h"
#include "tests/server/raw_client.h"

namespace remesh::server {
namespace {

/// A connection without a network, and its client's end.
struct Pair {
  Pair() {
    std::array<int, 2> ends{};
    if (::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()) != 0) throw std::runtime_error("no socket pair");
    connection.emplace(ends[0]);
    client = ends[1];
  }
  ~Pair() { ::close(client); }
  Pair(const Pair&) = delete;
  Pair& operator=(const Pair&) = delete;

  void send(std::string_view text) const {
    ASSERT_EQ(::send(client, text.data(), text.size(), MSG_NOSIGNAL), static_cast<ssize_t>(text.size()));
  }
  std::string read() {
    std::array<char, 16> buffer{};
    return {buffer.data(), connection->read_some(buffer.data(), buffer.size(), Clock::now() + kPatience)};
  }

  std::optional<Connection> connection;
  int client = -1;
  Event end;
};

Clock::time_point soon() { return Clock::now() + kPatience; }

TEST(connection_places, the_one_that_has_waited_longest_goes) {
  ConnectionPlaces places(2);
  Event first, second, third;
  {
    const ConnectionPlaces::Wait a(places, first), b(places, second);
    EXPECT_FALSE(first.wait(Clock::now()));
    const ConnectionPlaces::Wait c(places, third);
    EXPECT_EQ(places.waiting(), 3u) << "until its thread has seen it";
    EXPECT_TRUE(first.wait(Clock::now()));
    EXPECT_FALSE(second.wait(Clock::now()));
    EXPECT_FALSE(third.wait(Clock::now()));
  }
  EXPECT_EQ(places.waiting(), 0u);
  const ConnectionPlaces::Wait again(places, first);
  EXPECT_FALSE(first.wait(Clock::now()));
}

TEST(connection_places, one_that_is_served_ends_the_longest_wait_only_if_there_is_no_free_place) {
  ConnectionPlaces places(3);
  Event first, second;
  const ConnectionPlaces::Wait a(places, first), b(places, second);
  const auto free_place = places.enter();
  ASSERT_TRUE(free_place);
  EXPECT_FALSE(first.wait(Clock::now()));
  const auto of_the_first = places.enter();
  ASSERT_TRUE(of_the_first);
  EXPECT_TRUE(first.wait(Clock::now()));
  EXPECT_FALSE(second.wait(Clock::now()));
  auto of_the_second = places.enter();
  ASSERT_TRUE(of_the_second);
  EXPECT_TRUE(second.wait(Clock::now()));
  EXPECT_FALSE(places.enter()) << "all three are served";
  EXPECT_EQ(places.served(), 3u);
  of_the_second.reset();
  EXPECT_TRUE(places.enter());
}

TEST(connection_places, all_end_and_begin_again) {
  ConnectionPlaces places(2);
  Event before, after, anew;
  const ConnectionPlaces::Wait a(places, before);
  places.end_all();
  EXPECT_TRUE(places.is_over());
  EXPECT_TRUE(before.wait(Clock::now()));
  const ConnectionPlaces::Wait b(places, after);
  EXPECT_TRUE(after.wait(Clock::now()));
  places.begin_again();
  EXPECT_FALSE(places.is_over());
  const ConnectionPlaces::Wait c(places, anew);
  EXPECT_FALSE(anew.wait(Clock::now()));
}

TEST(connection_places, a_request_that_comes_as_its_connection_is_ended_is_read_to_its_end) {
  ConnectionPlaces places(1);
  Pair pair;
  Event other;
  {
    const ConnectionPlaces::Wait wait(places, pair.end);
    pair.send("begun");
    const ConnectionPlaces::Wait next(places, other);
    EXPECT_TRUE(pair.connection->wait_for_input(pair.end, soon()));
  }
  EXPECT_EQ(pair.read(), "begun");
  pair.send(" and ended");
  EXPECT_EQ(pair.read(), " and ended");
  EXPECT_EQ(pair.connection->wait(nullptr, Clock::now() + std::chrono::milliseconds(10)), Connection::Wake::kTime);
}

TEST(connection_places, the_wait_ends_by_the_event_the_time_and_the_client) {
  Pair pair;
  EXPECT_FALSE(pair.connection->wait_for_input(pair.end, Clock::now()));
  pair.end.set();
  EXPECT_FALSE(pair.connection->wait_for_input(pair.end, soon()));
  pair.end.clear();
  ::shutdown(pair.client, SHUT_WR);
  EXPECT_FALSE(pair.connection->wait_for_input(pair.end, soon()));
}

TEST(connection_threads, those_that_wait_are_told_before_a_shutdown_waits_for_them) {
  Event end;
  ConnectionThreads threads(4, [&] { end.set(); });
  std::atomic<int> served = 0;
  for (int i = 0; i < 2; ++i) threads.enqueue([&] { served += end.wait(soon()) ? 1 : 0; });
  threads.shutdown();
  EXPECT_EQ(served, 2);
}

}  // namespace
}  // namespace remesh::server
