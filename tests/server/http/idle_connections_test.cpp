#include "server/http/idle_connections.h"

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

TEST(idle_connections, the_one_that_has_waited_longest_goes) {
  IdleConnections idle(2);
  Event first, second, third;
  {
    const IdleConnections::Stay a(idle, first), b(idle, second);
    EXPECT_FALSE(first.wait(Clock::now()));
    const IdleConnections::Stay c(idle, third);
    EXPECT_EQ(idle.count(), 3u) << "until its thread has seen it";
    EXPECT_TRUE(first.wait(Clock::now()));
    EXPECT_FALSE(second.wait(Clock::now()));
    EXPECT_FALSE(third.wait(Clock::now()));
  }
  EXPECT_EQ(idle.count(), 0u);
  const IdleConnections::Stay again(idle, first);
  EXPECT_FALSE(first.wait(Clock::now()));
}

TEST(idle_connections, all_end_and_begin_again) {
  IdleConnections idle(2);
  Event before, after, anew;
  const IdleConnections::Stay a(idle, before);
  idle.end_all();
  EXPECT_TRUE(idle.is_over());
  EXPECT_TRUE(before.wait(Clock::now()));
  const IdleConnections::Stay b(idle, after);
  EXPECT_TRUE(after.wait(Clock::now()));
  idle.begin_again();
  EXPECT_FALSE(idle.is_over());
  const IdleConnections::Stay c(idle, anew);
  EXPECT_FALSE(anew.wait(Clock::now()));
}

TEST(idle_connections, a_request_that_comes_as_its_connection_is_ended_is_read_to_its_end) {
  IdleConnections idle(1);
  Pair pair;
  Event other;
  {
    const IdleConnections::Stay stay(idle, pair.end);
    pair.send("begun");
    const IdleConnections::Stay next(idle, other);
    EXPECT_TRUE(pair.connection->wait_for_input(pair.end, soon()));
  }
  EXPECT_EQ(pair.read(), "begun");
  pair.send(" and ended");
  EXPECT_EQ(pair.read(), " and ended");
  EXPECT_EQ(pair.connection->wait(nullptr, Clock::now() + std::chrono::milliseconds(10)), Connection::Wake::kTime);
}

TEST(idle_connections, the_wait_ends_by_the_event_the_time_and_the_client) {
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
