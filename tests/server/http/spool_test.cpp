#include "server/http/spool.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>

#include "server/http/large_answer.h"
#include "server/observe/log.h"
#include "tests/server/raw_client.h"
#include "tests/support/temporary_folder.h"

namespace remesh::server {
namespace {

/// A connection without a network, and its client's end.
struct ConnectedPair {
  ConnectedPair() {
    log::set_up(log::Format::kText, log::Level::kError);
    std::array<int, 2> ends{};
    if (::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()) != 0) throw std::runtime_error("no socket pair");
    connection.emplace(ends[0]);
    client = ends[1];
  }
  ~ConnectedPair() { ::close(client); }
  ConnectedPair(const ConnectedPair&) = delete;
  ConnectedPair& operator=(const ConnectedPair&) = delete;

  std::string read(std::size_t size) const {
    std::string bytes(size, '\0');
    std::size_t got = 0;
    while (got < size) {
      const ssize_t part = ::recv(client, bytes.data() + got, size - got, 0);
      if (part <= 0) break;
      got += static_cast<std::size_t>(part);
    }
    bytes.resize(got);
    return bytes;
  }

  std::optional<Connection> connection;
  int client = -1;
};

std::string sample(std::size_t size) {
  std::string text(size, '\0');
  for (std::size_t i = 0; i < size; ++i) text[i] = static_cast<char>('a' + i * 7919 % 26);
  return text;
}

constexpr std::uint64_t kPlenty = 1 << 30;

TEST(spool, the_rest_of_an_answer_is_in_a_file_until_its_reader_is_gone) {
  const test::TemporaryFolder folder;
  Spool spool(folder.path(), kPlenty, 0);
  ConnectedPair pair;
  {
    Spool::Reader reader(spool, *pair.connection);
    const std::string rest = sample(3'000'000);
    EXPECT_TRUE(reader.place(rest));
    EXPECT_EQ(spool.in_files(), rest.size());
    std::string found(rest.size(), '\0');
    EXPECT_EQ(::pread(reader.fd(), found.data(), found.size(), 0), static_cast<ssize_t>(rest.size()));
    EXPECT_EQ(found, rest);
  }
  EXPECT_EQ(spool.in_files(), 0u);
}

TEST(spool, without_a_folder_answers_stay_in_memory_up_to_a_bound) {
  Spool spool("/nowhere", kPlenty, 100);
  ConnectedPair pair;
  Spool::Reader reader(spool, *pair.connection);
  EXPECT_FALSE(reader.place(sample(100)));
  EXPECT_EQ(spool.held(), 100u);
  ConnectedPair other;
  Spool::Reader second(spool, *other.connection);
  reader.record_sent(1'000'000);
  EXPECT_THROW(second.place(sample(1)), ConnectionLost) << "it is the slowest";
}

TEST(spool, the_slowest_reader_makes_room_for_another) {
  const test::TemporaryFolder folder;
  Spool spool(folder.path(), 1000, 0);
  ConnectedPair slow, fast;
  std::optional<Spool::Reader> first(std::in_place, spool, *slow.connection);
  EXPECT_TRUE(first->place(sample(800)));
  Spool::Reader second(spool, *fast.connection);
  second.record_sent(1'000'000);
  std::thread owner([&] {
    // The connection of the slowest one ends, and then its own thread frees its place.
    EXPECT_EQ(slow.read(1), "");
    first.reset();
  });
  EXPECT_TRUE(second.place(sample(900)));
  owner.join();
  EXPECT_EQ(spool.in_files(), 900u);
}

TEST(large_answer, a_reader_that_keeps_up_needs_no_spool) {
  Spool spool("/nowhere", 0, 0);
  ConnectedPair pair;
  const std::string body = sample(20'000'000);
  std::string got;
  std::thread client([&] { got = pair.read(body.size()); });
  send_large(*pair.connection, body, spool, [] { ADD_FAILURE() << "the memory was taken until the end"; });
  client.join();
  EXPECT_TRUE(got == body);
}

TEST(large_answer, a_reader_that_pauses_gets_the_same_bytes_from_the_spool) {
  const test::TemporaryFolder folder;
  Spool spool(folder.path(), kPlenty, 0);
  ConnectedPair pair;
  const std::string body = sample(20'000'000);
  std::atomic<bool> is_released = false;
  std::thread server([&] { send_large(*pair.connection, body, spool, [&] { is_released = true; }); });
  EXPECT_TRUE(eventually([&] { return spool.is_in_memory() ? spool.in_files() > 0 : is_released.load(); }));
  EXPECT_GT(spool.in_files(), 15'000'000u);
  EXPECT_TRUE(pair.read(body.size()) == body);
  server.join();
  EXPECT_EQ(spool.in_files(), 0u);
}

}  // namespace
}  // namespace remesh::server
