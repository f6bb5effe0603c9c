#include "server/http/partial_content.h"

#include <gtest/gtest.h>

namespace remesh::server {
namespace {

Response answer() {
  Response answer;
  answer.content_type = "model/obj";
  answer.body = "0123456789";
  answer.headers = {{"Repr-Digest", "sha-256=:ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopq=:"}};
  return answer;
}
const std::string kTag = "\"ABCDEFGHIJKLMNOPQRSTUV\"";

Response answer_with(const Fields& fields, const std::string& method = "GET") {
  RequestHead head;
  head.method = method;
  head.headers = fields;
  return with_ranges(answer(), head);
}

std::string header(const Response& response, const std::string& name) {
  for (const auto& [key, value] : response.headers) {
    if (key == name) return value;
  }
  return "";
}

TEST(partial_content, a_result_has_a_tag_and_takes_ranges) {
  const Response whole = answer_with({});
  EXPECT_EQ(whole.status, 200);
  EXPECT_EQ(header(whole, "ETag"), kTag);
  EXPECT_EQ(header(whole, "Accept-Ranges"), "bytes");
  EXPECT_EQ(whole.body, "0123456789");
}

TEST(partial_content, a_client_that_has_it_gets_nothing) {
  for (const std::string& list : {kTag, "W/" + kTag, "\"x\", " + kTag, std::string("*")}) {
    const Response response = answer_with({{"if-none-match", list}});
    EXPECT_EQ(response.status, 304) << list;
    EXPECT_EQ(response.body, "");
  }
  EXPECT_EQ(answer_with({{"if-none-match", "\"x\""}, {"if-none-match", kTag}}).status, 304);
  EXPECT_EQ(answer_with({{"if-none-match", "\"x\""}}).status, 200);
}

TEST(partial_content, a_client_that_wants_these_bytes_alone_gets_no_others) {
  for (const std::string& list : {kTag, "\"x\", " + kTag, std::string("*")})
    EXPECT_EQ(answer_with({{"if-match", list}}).status, 200) << list;
  for (const std::string& list : {"W/" + kTag, std::string("\"x\""), std::string()}) {
    try {
      answer_with({{"if-match", list}, {"range", "bytes=1-2"}});
      ADD_FAILURE() << list;
    } catch (const HttpError& error) {
      EXPECT_EQ(error.problem.status, 412) << list;
    }
  }
}

TEST(partial_content, no_more_is_read_than_is_sent) {
  Response head = answer();
  const std::string body = std::exchange(head.body, {});
  std::string read;
  const auto ask = [&](const std::string& method, const Fields& fields) {
    RequestHead request;
    request.method = method;
    request.headers = fields;
    read.clear();
    return with_ranges(head, request, body.size(),
                       [&](std::uint64_t begin, std::uint64_t end) { return read = body.substr(begin, end - begin); });
  };
  EXPECT_EQ(ask("GET", {{"range", "bytes=3-5"}}).body, "345");
  EXPECT_EQ(read, "345");
  EXPECT_EQ(ask("HEAD", {}).size_for_head, 10u);
  EXPECT_EQ(read, "");
  EXPECT_EQ(ask("GET", {{"if-none-match", kTag}}).status, 304);
  EXPECT_EQ(read, "");
  EXPECT_EQ(ask("GET", {}).body, body);
}

TEST(partial_content, one_range_is_a_part) {
  const auto part = [](const std::string& range) {
    const Response response = answer_with({{"range", range}});
    return std::to_string(response.status) + " " + header(response, "Content-Range") + " " + response.body;
  };
  EXPECT_EQ(part("bytes=2-4"), "206 bytes 2-4/10 234");
  EXPECT_EQ(part("bytes=7-"), "206 bytes 7-9/10 789");
  EXPECT_EQ(part("bytes=-2"), "206 bytes 8-9/10 89");
  EXPECT_EQ(part("bytes=-20"), "206 bytes 0-9/10 0123456789");
  EXPECT_EQ(part("Bytes = 8-99"), "206 bytes 8-9/10 89");
  EXPECT_EQ(part("bytes=0-18446744073709551615"), "206 bytes 0-9/10 0123456789");
}

TEST(partial_content, what_is_no_single_range_gets_the_whole) {
  for (const char* range :
       {"bytes=1-2,4-5", "bytes=4-2", "bytes=", "bytes=x-", "lines=1-2", "bytes", "bytes=-", "bytes=1-2x"})
    EXPECT_EQ(answer_with({{"range", range}}).status, 200) << range;
  EXPECT_EQ(answer_with({{"range", "bytes=1-2"}}, "HEAD").status, 200);
  EXPECT_EQ(answer_with({{"range", "bytes=1-2"}, {"if-range", "\"other\""}}).status, 200);
  EXPECT_EQ(answer_with({{"range", "bytes=1-2"}, {"if-range", kTag}}).status, 206);
}

TEST(partial_content, a_range_beyond_the_end_is_told_where_the_end_is) {
  for (const char* range : {"bytes=10-", "bytes=99-100", "bytes=-0"}) {
    try {
      answer_with({{"range", range}});
      ADD_FAILURE() << range;
    } catch (const HttpError& error) {
      EXPECT_EQ(error.problem.status, 416);
      EXPECT_EQ(error.headers.front(), (std::pair<std::string, std::string>("Content-Range", "bytes */10")));
    }
  }
}

}  // namespace
}  // namespace remesh::server
