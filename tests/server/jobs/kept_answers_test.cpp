#include "server/jobs/kept_answers.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace remesh::server::jobs {
namespace {

constexpr std::uint64_t kEnough = 1 << 20;

/// A request on a connection whose client is there.
struct Asking {
  Asking() {
    std::array<int, 2> ends{};
    if (::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()) != 0) throw std::runtime_error("no socket pair");
    connection = std::make_unique<Connection>(ends[0]);
    client = ends[1];
  }
  ~Asking() { ::close(client); }
  Call call() { return {request, *connection, ""}; }

  Request request;
  std::unique_ptr<Connection> connection;
  int client = -1;
};

Response answer_of(const std::string& body) {
  Response answer;
  answer.content_type = "model/obj";
  answer.body = body;
  return answer;
}

TEST(kept_answers, an_answer_that_many_ask_for_at_once_is_made_once) {
  const test::TemporaryFolder folder;
  Spool spool(folder.path(), kEnough, 0);
  KeptAnswers kept(spool);
  std::atomic<int> made = 0;
  std::vector<std::string> got(8);
  std::vector<std::thread> askers;
  for (std::string& text : got)
    askers.emplace_back([&] {
      Asking asking;
      std::optional<Response> answer;
      const auto make = [&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        ++made;
        return answer_of("0123456789");
      };
      text = kept.get("one", asking.call(), make, answer)->body.read(3, 6);
    });
  for (std::thread& asker : askers) asker.join();
  EXPECT_EQ(made, 1);
  for (const std::string& text : got) EXPECT_EQ(text, "345");
  EXPECT_EQ(spool.in_files(), 10u);
  EXPECT_EQ(kept.find("one")->head.content_type, "model/obj");
  EXPECT_EQ(kept.find("other"), nullptr);
  kept.forget("on");
  EXPECT_EQ(kept.find("one"), nullptr);
  EXPECT_EQ(spool.in_files(), 0u);
}

TEST(kept_answers, one_that_fails_is_made_anew_by_the_next_who_asks) {
  const test::TemporaryFolder folder;
  Spool spool(folder.path(), kEnough, 0);
  KeptAnswers kept(spool);
  Asking asking;
  std::optional<Response> made;
  const auto fail = []() -> Response { throw std::runtime_error("not now"); };
  EXPECT_THROW(kept.get("one", asking.call(), fail, made), std::runtime_error);
  EXPECT_NE(kept.get(
                "one", asking.call(), [] { return answer_of("text"); }, made),
            nullptr);
  EXPECT_FALSE(made);
}

TEST(kept_answers, what_has_no_room_is_given_to_who_has_made_it) {
  const test::TemporaryFolder folder;
  Spool spool(folder.path(), /*max_bytes=*/10, 0);  // half of them are for answers that are kept
  KeptAnswers kept(spool);
  Asking asking;
  std::optional<Response> made;
  EXPECT_EQ(kept.get(
                "one", asking.call(), [] { return answer_of("012345"); }, made),
            nullptr);
  ASSERT_TRUE(made);
  EXPECT_EQ(made->body, "012345");
  EXPECT_NE(kept.get(
                "two", asking.call(), [] { return answer_of("01234"); }, made),
            nullptr);
}

TEST(kept_answers, the_least_used_one_goes_when_there_are_too_many) {
  const test::TemporaryFolder folder;
  Spool spool(folder.path(), kEnough, 0);
  KeptAnswers kept(spool);
  Asking asking;
  std::optional<Response> made;
  for (int i = 0; i < 40; ++i) {
    kept.get(
        std::to_string(i), asking.call(), [] { return answer_of("0123456789"); }, made);
    EXPECT_NE(kept.find("0"), nullptr) << i;
  }
  EXPECT_EQ(kept.find("1"), nullptr);
  EXPECT_LE(spool.in_files(), 320u);
}

}  // namespace
}  // namespace remesh::server::jobs
