#include "server/router.h"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <array>

#include "server/response_writer.h"

namespace remesh::server {
namespace {

Router example() {
  const auto named = [](std::string name) {
    return [name](const Call& call) {
      Response response;
      response.body = name + ":" + call.parameter;
      return response;
    };
  };
  return Router({{"GET", "/", named("root")},
                 {"POST", "/v1/remesh", named("remesh"), [] { return std::uint64_t{77}; }},
                 {"GET", "/v1/requests/{id}", named("show")},
                 {"DELETE", "/v1/requests/{id}", named("cancel")},
                 {"GET", "/v1/requests/{id}/events", named("follow")}});
}

class RouterTest : public ::testing::Test {
 protected:
  std::string answer(const std::string& method, const std::string& path) {
    Request request;
    request.method = method;
    request.path = path;
    std::array<int, 2> ends{};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0);
    Connection connection(ends[0]);
    const Connection other(ends[1]);
    try {
      const Response response = example().answer(request, connection);
      return response.headers.empty() ? response.body : response.headers[0].second;
    } catch (const HttpError& error) {
      return std::to_string(error.problem.status) + (error.headers.empty() ? "" : " " + error.headers[0].second);
    }
  }
};

TEST_F(RouterTest, method_and_path_find_their_handler) {
  EXPECT_EQ(answer("GET", "/"), "root:");
  EXPECT_EQ(answer("POST", "/v1/remesh"), "remesh:");
  EXPECT_EQ(answer("GET", "/v1/requests/abc"), "show:abc");
  EXPECT_EQ(answer("DELETE", "/v1/requests/abc"), "cancel:abc");
  EXPECT_EQ(answer("GET", "/v1/requests/abc/events"), "follow:abc");
  EXPECT_EQ(answer("HEAD", "/v1/requests/abc"), "show:abc");
}

TEST_F(RouterTest, other_paths_are_not_found) {
  for (const char* path : {"/v1", "/v1/remesh/", "/v1/remeshx", "/v1/requests", "/v1/requests/", "/v1/requests//events",
                           "//", "/v1/requests/a/b"}) {
    EXPECT_EQ(answer("GET", path), "404") << path;
  }
}

TEST_F(RouterTest, other_methods_are_told_what_is_allowed) {
  EXPECT_EQ(answer("GET", "/v1/remesh"), "405 POST, OPTIONS");
  EXPECT_EQ(answer("PUT", "/v1/requests/abc"), "405 GET, HEAD, DELETE, OPTIONS");
  EXPECT_EQ(answer("OPTIONS", "/v1/requests/abc"), "GET, HEAD, DELETE, OPTIONS");
}

TEST_F(RouterTest, only_a_route_that_says_so_takes_a_body) {
  RequestHead head;
  head.method = "POST";
  head.path = "/v1/remesh";
  EXPECT_EQ(example().admit(head), 77u);
  head.method = "GET";
  head.path = "/";
  EXPECT_EQ(example().admit(head), 0u);
  head.path = "/nothing";
  EXPECT_THROW(example().admit(head), HttpError);
}

TEST(ResponseHead, a_value_cannot_start_a_field_of_its_own) {
  Request request;
  request.id = "abcdefgh-12345678";
  Response response;
  response.headers = {{"Content-Disposition", "a\r\nSet-Cookie: x=\x01y"}};
  const std::string head = response_head(request, response);
  EXPECT_EQ(head.find("\nSet-Cookie"), std::string::npos);
  EXPECT_NE(head.find("Content-Disposition: a  Set-Cookie: x= y\r\n"), std::string::npos) << head;
  EXPECT_EQ(head.rfind("HTTP/1.1 200 ", 0), 0u);
  EXPECT_NE(head.find("\r\nConnection: close\r\n"), std::string::npos);
}

}  // namespace
}  // namespace remesh::server
