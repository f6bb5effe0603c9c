#include "server/observe/log.h"

#include <gtest/gtest.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <memory>
#include <string>

#include "server/observe/log_sink.h"

namespace remesh::server::log {
namespace {

TEST(log, values_stand_by_their_names) {
  EXPECT_EQ(render(Format::kText, "request", {{"path", "/a"}, {"status", std::int64_t{200}}, {"ms", 1.5}}),
            "request path=/a status=200 ms=1.500");
  EXPECT_EQ(render(Format::kJson, "request", {{"path", "/a"}, {"status", std::int64_t{200}}}),
            R"("event":"request","path":"/a","status":200)");
}

TEST(log, what_clients_send_cannot_forge_a_line) {
  const std::string evil = "a\r\n\"level\":\"x\" \x1b[2J\xff\\";
  for (const Format format : {Format::kText, Format::kJson}) {
    const std::string line = render(format, "request", {{"path", evil}});
    for (const char c : line) EXPECT_TRUE(c >= 0x20 && c < 0x7f);
    EXPECT_NE(line.find(R"("a\u000d\u000a\"level\":\"x\" \u001b[2J\u00ff\\")"), std::string::npos) << line;
  }
}

/// Makes a logger that writes to a descriptor as the daemon's does to standard error.
std::shared_ptr<spdlog::logger> logger_on(const std::shared_ptr<LogSink>& sink) {
  auto logger = std::make_shared<spdlog::logger>("test", sink);
  logger->set_pattern("%v");
  return logger;
}

TEST(log_sink, lines_reach_a_pipe_and_a_socket_whole) {
  for (const bool is_socket : {false, true}) {
    std::array<int, 2> ends{};
    if (is_socket) {
      ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0);
    } else {
      ASSERT_EQ(::pipe(ends.data()), 0);
    }
    const auto sink = std::make_shared<LogSink>(ends[1]);
    const std::string line(10'000, 'x');
    logger_on(sink)->info(line);
    std::string got(line.size() + 1, ' ');
    std::size_t length = 0;
    while (length < got.size()) {
      const ssize_t part = ::read(ends[0], got.data() + length, got.size() - length);
      ASSERT_GT(part, 0);
      length += static_cast<std::size_t>(part);
    }
    EXPECT_EQ(got, line + "\n");
    EXPECT_EQ(sink->dropped(), 0u);
    for (const int end : ends) ::close(end);
  }
}

TEST(log_sink, a_pipe_that_nobody_reads_does_not_block_the_end) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  const auto sink = std::make_shared<LogSink>(ends[1]);
  sink->end_at(std::chrono::steady_clock::now());
  const auto logger = logger_on(sink);
  for (int i = 0; i < 100; ++i) logger->info(std::string(4000, 'x'));  // a pipe takes 64 KiB
  EXPECT_GT(sink->dropped(), 50u);
  for (const int end : ends) ::close(end);
}

}  // namespace
}  // namespace remesh::server::log
