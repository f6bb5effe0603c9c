#include "server/http/request_head.h"

#include <gtest/gtest.h>

namespace remesh::server {
namespace {

int status_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const HttpError& error) {
    return error.problem.status;
  }
  return 0;
}

RequestHead parsed(const std::string& text) {
  RequestHead head;
  parse_head(text, {}, head);
  return head;
}

int status_of_head(const std::string& text) {
  return status_of([&] {
    std::size_t checked = 0;
    const auto end = find_head_end(text, checked, {});
    ASSERT_TRUE(end.has_value());
    framing(parsed(text.substr(0, *end)));
  });
}

TEST(request_head, other_versions_are_told_apart_from_nonsense) {
  for (const char* version : {"HTTP/2.0", "HTTP/1.2", "HTTP/0.9", "HTTP/3.0"})
    EXPECT_EQ(status_of_head("GET / " + std::string(version) + "\r\nHost: localhost\r\n\r\n"), 505) << version;
  EXPECT_EQ(status_of_head("PRI * HTTP/2.0\r\n\r\n"), 505) << "with this HTTP/2 begins";
  for (const char* version : {"HTTP/2", "HTTP/1.10", "http/1.1", "HTTP/1,1", "HTTPS/1.1"})
    EXPECT_EQ(status_of_head("GET / " + std::string(version) + "\r\nHost: localhost\r\n\r\n"), 400) << version;
}

TEST(request_head, fields_that_are_lists_are_joined_and_others_come_once) {
  const RequestHead head =
      parsed("GET / HTTP/1.1\r\nHost: h\r\nAccept: a\r\nX: 1\r\naccept:\r\nACCEPT: b;q=1, c\r\n\r\n");
  EXPECT_EQ(head.list("accept"), "a, b;q=1, c");
  EXPECT_EQ(head.list("prefer"), "");
  EXPECT_TRUE(head.has("x"));
  EXPECT_FALSE(head.has("prefer"));
  for (const char* name : {"Content-Type", "Authorization", "X-API-Key", "Idempotency-Key"}) {
    const std::string field = std::string(name) + ": x\r\n";
    EXPECT_EQ(status_of_head("GET / HTTP/1.1\r\nHost: h\r\n" + field + "\r\n"), 0) << name;
    EXPECT_EQ(status_of_head("GET / HTTP/1.1\r\nHost: h\r\n" + field + field + "\r\n"), 400) << name;
  }
}

TEST(request_head, the_host_of_an_absolute_target_is_the_authority) {
  EXPECT_EQ(parsed("GET http://a:1/x HTTP/1.1\r\nHost: b\r\n\r\n").authority(), "a:1");
  EXPECT_EQ(parsed("GET /x HTTP/1.1\r\nHost: b\r\n\r\n").authority(), "b");
  EXPECT_EQ(status_of_head("GET http://user@a/ HTTP/1.1\r\nHost: a\r\n\r\n"), 400);
}

TEST(request_head, a_plain_head_is_read_whole) {
  const RequestHead head =
      parsed("POST /v1/re%6desh?a=1e+5&b=%20x&c HTTP/1.1\r\nHost: h\r\nContent-TYPE:  model/obj \t\r\n\r\n");
  EXPECT_EQ(head.method, "POST");
  EXPECT_EQ(head.path, "/v1/remesh");
  EXPECT_EQ(head.query, (Fields{{"a", "1e+5"}, {"b", " x"}, {"c", ""}}));
  EXPECT_EQ(head.header("content-type"), "model/obj");
  EXPECT_EQ(head.header("absent"), "");
  EXPECT_EQ(head.minor_version, 1);
}

TEST(request_head, a_connection_is_kept_unless_the_client_says_close_and_before_1_1_only_if_it_asks) {
  const auto keeps = [](const std::string& version, const std::string& fields) {
    return wants_to_be_kept(parsed("GET / HTTP/" + version + "\r\nHost: h\r\n" + fields + "\r\n"));
  };
  for (const char* asks : {"Connection: keep-alive\r\n", "Connection: TE , Keep-Alive,\r\n",
                           "Connection: x\r\nConnection: keep-alive\r\n"}) {
    EXPECT_TRUE(keeps("1.1", asks)) << asks;
    EXPECT_TRUE(keeps("1.0", asks)) << asks;
  }
  for (const char* silent :
       {"", "Connection:\r\n", "Connection: keep-alives, closes\r\n", "Keep-Alive: timeout=5\r\n"}) {
    EXPECT_TRUE(keeps("1.1", silent)) << silent;
    EXPECT_FALSE(keeps("1.0", silent)) << silent;
  }
  for (const char* ends : {"Connection: close\r\n", "Connection: keep-alive, CLOSE\r\n",
                           "Connection: keep-alive\r\nConnection: close\r\n"}) {
    EXPECT_FALSE(keeps("1.1", ends)) << ends;
    EXPECT_FALSE(keeps("1.0", ends)) << ends;
  }
}

TEST(request_head, the_absolute_form_of_a_target_is_understood) {
  EXPECT_EQ(parsed("GET http://h:1/livez?x=1 HTTP/1.1\r\nHost: h\r\n\r\n").path, "/livez");
  EXPECT_EQ(parsed("GET http://h HTTP/1.1\r\nHost: h\r\n\r\n").path, "/");
  EXPECT_EQ(parsed("GET HTTPS://h?x=1 HTTP/1.1\r\nHost: h\r\n\r\n").path, "/");
  EXPECT_EQ(parsed("GET http://h?x=1 HTTP/1.1\r\nHost: h\r\n\r\n").query, (Fields{{"x", "1"}}));
}

TEST(request_head, a_host_is_a_name_or_an_address_with_or_without_a_port_or_empty) {
  for (const char* host : {"", "localhost:8080", "mesh_1.example.org", "[::1]:80", "127.0.0.1", "%C3%A4.example"}) {
    EXPECT_EQ(status_of_head("GET / HTTP/1.1\r\nHost: " + std::string(host) + "\r\n\r\n"), 0) << host;
  }
}

TEST(request_head, the_end_is_found_however_the_bytes_are_cut) {
  const std::string text = "GET / HTTP/1.1\r\nHost: localhost\r\n\r\nbody";
  for (std::size_t cut = 0; cut < text.size(); ++cut) {
    std::size_t checked = 0;
    const auto early = find_head_end(std::string_view(text).substr(0, cut), checked, {});
    const auto end = early ? early : find_head_end(text, checked, {});
    EXPECT_EQ(end, text.size() - 4) << cut;
  }
}

TEST(request_head, what_two_programs_could_read_differently_is_malformed) {
  const std::string start = "POST /v1/remesh HTTP/1.1\r\n";
  for (const std::string& text : {
           std::string("GET / HTTP/1.1\nHost: localhost\n\n"),                      // bare line feeds
           std::string("GET / HTTP/1.1\r\nHost: localhost\n\r\n\r\n"),              //
           std::string("GET / HTTP/1.1\r\nHo\rst: x\r\n\r\n"),                      // carriage return inside
           std::string("GET / HTTP/1.1\r\nHost: a\0b\r\n\r\n", 29),                 // NUL
           std::string("GET /%00 HTTP/1.1\r\nHost: localhost\r\n\r\n"),             //
           std::string("GET /%4 HTTP/1.1\r\nHost: localhost\r\n\r\n"),              // incomplete escape
           std::string("GET / HTTP/1.1\r\nHost: localhost\r\n folded\r\n\r\n"),     //
           std::string("GET / HTTP/1.1\r\nHost : x\r\n\r\n"),                       // blank before the colon
           std::string("GET / HTTP/1.1\r\nHost: localhost\r\nno colon\r\n\r\n"),    //
           std::string("GET / HTTP/1.1\r\nHost: localhost\r\n: nameless\r\n\r\n"),  //
           std::string("GET / HTTP/1.1\r\nHost: localhost\r\nHost: y\r\n\r\n"),     //
           std::string("GET / HTTP/1.1\r\n\r\n"),                                   // no Host
           std::string("GET / x HTTP/1.1\r\nHost: localhost\r\n\r\n"),              // blank in the target
           std::string("GET HTTP/1.1\r\nHost: localhost\r\n\r\n"),                  //
           std::string("G@T / HTTP/1.1\r\nHost: localhost\r\n\r\n"),                //
           std::string("GET nopath HTTP/1.1\r\nHost: localhost\r\n\r\n"),           //
           std::string("GET %2flivez HTTP/1.1\r\nHost: localhost\r\n\r\n"),         // a path only once it is decoded
           std::string("GET ?a=b HTTP/1.1\r\nHost: localhost\r\n\r\n"),             //
           std::string("OPTIONS %2a HTTP/1.1\r\nHost: localhost\r\n\r\n"),          //
           std::string("GET / HTTP/1.1\r\nHost: a b\r\n\r\n"),                      // no host
           std::string("GET / HTTP/1.1\r\nHost: a/b\r\n\r\n"),                      //
           std::string("GET / HTTP/1.0\r\nHost: user@a\r\n\r\n"),                   //
           std::string("\r\nGET / HTTP/1.1\r\nHost: localhost\r\n\r\n"),            //
           start + "Host: localhost\r\nContent-Length: 3\r\nContent-Length: 3\r\n\r\n",  //
           start + "Host: localhost\r\nContent-Length: 3, 3\r\n\r\n",                    //
           start + "Host: localhost\r\nContent-Length: +3\r\n\r\n",                      //
           start + "Host: localhost\r\nContent-Length: -3\r\n\r\n",                      //
           start + "Host: localhost\r\nContent-Length: 0x3\r\n\r\n",                     //
           start + "Host: localhost\r\nContent-Length:\r\n\r\n",                         //
           start + "Host: localhost\r\nContent-Length: 99999999999999999999\r\n\r\n",    //
           start + "Host: localhost\r\nContent-Length: 3\r\nTransfer-Encoding: chunked\r\n\r\n",
           start + "Host: localhost\r\nTransfer-Encoding: chunked\r\nTransfer-Encoding: chunked\r\n\r\n",
           std::string("POST / HTTP/1.0\r\nTransfer-Encoding: chunked\r\n\r\n"),
       }) {
    EXPECT_EQ(status_of_head(text), 400) << text;
  }
}

TEST(request_head, an_unknown_transfer_coding_is_not_implemented) {
  EXPECT_EQ(status_of_head("POST / HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: gzip, chunked\r\n\r\n"), 501);
}

TEST(request_head, a_post_says_how_long_its_body_is) {
  EXPECT_EQ(status_of_head("POST / HTTP/1.1\r\nHost: localhost\r\n\r\n"), 411);
  const Framing length = framing(parsed("POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 12\r\n\r\n"));
  EXPECT_EQ(length.kind, Framing::Kind::kLength);
  EXPECT_EQ(length.length, 12u);
  EXPECT_EQ(framing(parsed("POST / HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: Chunked\r\n\r\n")).kind,
            Framing::Kind::kChunked);
  EXPECT_EQ(framing(parsed("GET / HTTP/1.0\r\n\r\n")).kind, Framing::Kind::kNone);
}

TEST(request_head, a_long_head_is_refused_before_it_ends) {
  std::size_t checked = 0;
  EXPECT_EQ(status_of([&] { find_head_end("GET /" + std::string(100'000, 'a'), checked, {}); }), 414);
  checked = 0;
  const std::string fields = "GET / HTTP/1.1\r\nHost: " + std::string(100'000, 'a');
  EXPECT_EQ(status_of([&] { find_head_end(fields, checked, {}); }), 431);

  std::string many = "GET / HTTP/1.1\r\nHost: localhost\r\n";
  for (int i = 0; i < 100; ++i) many += "a: b\r\n";
  EXPECT_EQ(status_of_head(many + "\r\n"), 431);
}

}  // namespace
}  // namespace remesh::server
