#include "server/http/gate.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <thread>
#include <vector>

namespace remesh::server {
namespace {

using std::chrono::milliseconds;

/// A gate that reads what a test writes into the other end of a socket pair.
class gate : public ::testing::Test {
 protected:
  void SetUp() override {
    std::array<int, 2> ends{};
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0);
    connection_.emplace(ends[0]);
    client_ = ends[1];
    limits_.head_timeout = std::chrono::hours(1);  // those that wait for its end make it short
    limits_.min_body_rate = 1000;
  }
  void TearDown() override { close_client(); }

  void close_client() {
    if (client_ >= 0) ::close(client_);
    client_ = -1;
  }
  void send(std::string_view text) {
    ASSERT_EQ(::send(client_, text.data(), text.size(), MSG_NOSIGNAL), static_cast<ssize_t>(text.size()));
  }
  /// Reads a request. Returns the status with which it is refused, or 200.
  int read() {
    try {
      const std::optional<Framing> framing = read_head(*connection_, limits_, request_);
      is_request_ = framing.has_value();
      if (is_request_) request_.body = read_body(*connection_, limits_, request_, *framing, max_body_, reserve_);
      return 200;
    } catch (const HttpError& error) {
      limit_ = error.problem.limit;
      return error.problem.status;
    }
  }

  std::optional<Connection> connection_;
  int client_ = -1;
  GateLimits limits_;
  std::uint64_t max_body_ = 100;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> reserved_;
  Reserve reserve_ = [this](std::uint64_t held, std::uint64_t expected) { reserved_.emplace_back(held, expected); };
  Request request_;
  bool is_request_ = false;
  std::optional<std::uint64_t> limit_;
};

TEST_F(gate, a_body_of_known_length_is_read_and_no_more) {
  send("POST /x HTTP/1.1\r\nHost: x\r\nContent-Length: 5\r\n\r\nhelloGET /");
  EXPECT_EQ(read(), 200);
  EXPECT_TRUE(is_request_);
  EXPECT_EQ(request_.body.view(), "hello");
  EXPECT_EQ(connection_->bytes_read(), 53u);
  connection_->begin_exchange();
  send("next HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_EQ(read(), 200);
  EXPECT_EQ(request_.path, "/next");
  EXPECT_EQ(connection_->bytes_read(), 31u);
}

TEST_F(gate, a_chunked_body_is_decoded) {
  send("POST /x HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n3\r\nabc\r\n");
  std::thread later([this] {
    std::this_thread::sleep_for(milliseconds(20));
    send("2\r\nde\r\n0\r\n\r\n");
  });
  EXPECT_EQ(read(), 200);
  later.join();
  EXPECT_EQ(request_.body.view(), "abcde");
}

TEST_F(gate, a_body_too_long_is_refused_before_it_comes) {
  send("POST /x HTTP/1.1\r\nHost: x\r\nContent-Length: 10000000000\r\n\r\n");
  EXPECT_EQ(read(), 413);
  EXPECT_EQ(limit_, 100u);
}

TEST_F(gate, a_large_body_is_taken_whole_however_it_comes) {
  max_body_ = 10 << 20;
  std::string large(3'000'000, ' ');
  for (std::size_t i = 0; i < large.size(); ++i) large[i] = static_cast<char>('a' + i * i % 26);
  for (const bool in_chunks : {false, true}) {
    std::thread client([&] {
      std::string text = "POST /x HTTP/1.1\r\nHost: x\r\n";
      text += in_chunks ? "Transfer-Encoding: chunked\r\n\r\n2DC6C0\r\n" + large + "\r\n0\r\n\r\n"
                        : "Content-Length: 3000000\r\n\r\n" + large;
      for (std::string_view rest = text; !rest.empty();) {
        const ssize_t put = ::send(client_, rest.data(), rest.size(), MSG_NOSIGNAL);
        if (put <= 0) return;
        rest.remove_prefix(static_cast<std::size_t>(put));
      }
    });
    EXPECT_EQ(read(), 200);
    client.join();
    EXPECT_TRUE(request_.body.is_in_file());
    EXPECT_TRUE(request_.body.view() == large) << (in_chunks ? "in chunks" : "with a length");
  }
}

TEST_F(gate, a_chunked_body_too_long_is_refused_where_it_passes_the_cap) {
  send("POST /x HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n65\r\n");
  EXPECT_EQ(read(), 413);
}

TEST_F(gate, the_client_that_waits_is_told_to_continue) {
  send("POST /x HTTP/1.1\r\nHost: x\r\nContent-Length: 2\r\nExpect: 100-continue\r\n\r\n");
  std::string told(25, ' ');
  std::thread later([this, &told] {
    ::recv(client_, told.data(), told.size(), MSG_WAITALL);
    send("ok");
  });
  EXPECT_EQ(read(), 200);
  later.join();
  EXPECT_EQ(told, "HTTP/1.1 100 Continue\r\n\r\n");
  EXPECT_EQ(request_.body.view(), "ok");
}

TEST_F(gate, a_refused_client_is_not_told_to_continue) {
  send("POST /x HTTP/1.1\r\nHost: x\r\nContent-Length: 200\r\nExpect: 100-continue\r\n\r\n");
  EXPECT_EQ(read(), 413);
  EXPECT_EQ(connection_->bytes_written(), 0u);
}

TEST_F(gate, a_slow_head_times_out_as_a_whole) {
  // A byte every 30 ms is never late for the next read; only a deadline for the whole head ends it.
  limits_.head_timeout = milliseconds(200);
  send("a");
  std::atomic<bool> goes_on = true;
  std::thread drip([&] {
    while (goes_on && ::send(client_, "a", 1, MSG_NOSIGNAL) > 0) std::this_thread::sleep_for(milliseconds(30));
  });
  const Clock::time_point start = Clock::now();
  EXPECT_EQ(read(), 408);
  EXPECT_GE(Clock::now() - start, limits_.head_timeout);
  goes_on = false;
  drip.join();
  EXPECT_FALSE(is_request_);
}

TEST_F(gate, a_body_that_stalls_times_out) {
  limits_.head_timeout = milliseconds(200);
  send("POST /x HTTP/1.1\r\nHost: x\r\nContent-Length: 50\r\n\r\nhello");
  EXPECT_EQ(read(), 408);
  EXPECT_TRUE(is_request_);
}

TEST_F(gate, a_body_cut_short_is_malformed) {
  send("POST /x HTTP/1.1\r\nHost: x\r\nContent-Length: 50\r\n\r\nhello");
  close_client();
  EXPECT_EQ(read(), 400);
}

TEST_F(gate, a_client_that_leaves_without_a_word_is_no_request) {
  close_client();
  EXPECT_EQ(read(), 200);
  EXPECT_FALSE(is_request_);
}

TEST_F(gate, a_client_that_stays_silent_is_no_request) {
  limits_.head_timeout = milliseconds(200);
  EXPECT_EQ(read(), 200);
  EXPECT_FALSE(is_request_);
}

TEST_F(gate, a_compressed_body_passes_as_it_is) {
  send("POST /x HTTP/1.1\r\nHost: x\r\nContent-Length: 5\r\nContent-Encoding: gzip\r\n\r\nhello");
  EXPECT_EQ(read(), 200);
  EXPECT_EQ(request_.body.view(), "hello");
}

TEST_F(gate, a_head_refused_for_its_framing_is_known_all_the_same) {
  send("POST /x HTTP/1.1\r\nHost: x\r\nX-Request-Id: abcdefgh-12345678\r\n\r\n");
  EXPECT_EQ(read(), 411);
  EXPECT_EQ(request_.header("x-request-id"), "abcdefgh-12345678");
}

}  // namespace
}  // namespace remesh::server
