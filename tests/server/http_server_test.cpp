/// Tests routing and the writing of answers over real connections.
#include "server/http_server.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "server/observe/log.h"
#include "tests/server/raw_client.h"
#include "tests/support/tcp_segments.h"

namespace remesh::server {
namespace {

Handler named(const std::string& name) {
  return [name](const Call& call) {
    Response response;
    response.body = name + ":" + call.parameter + ":" + std::string(call.request.body.view());
    return response;
  };
}

Response with_forged_fields(const Call&) {
  Response response;
  response.content_type = "text/plain\r\nX-Forged: 1";
  response.headers = {{"Content-Disposition", "a\r\nSet-Cookie: x=\x01y"}};
  return response;
}

Response in_pieces(const Call& call) {
  Response response;
  response.content_type = "text/event-stream";
  response.next_piece = [&connection = call.connection, left = 3]() mutable -> std::string {
    connection.wait(nullptr, Clock::now() + std::chrono::milliseconds(1));
    return left-- > 0 ? "piece " : "";
  };
  return response;
}

/// Answers with more than the buffers of a connection hold.
Response large(const Call&) {
  Response response;
  response.body.assign(30'000'000, 'x');
  return response;
}

class http_server : public ::testing::Test {
 protected:
  http_server() {
    log::set_up(log::Format::kText, log::Level::kError);
    server_.bind({"127.0.0.1", 0});
    server_.start();
  }
  Answer request(const std::string& method, const std::string& target, const std::string& fields = "") {
    return ask(server_.port(), method + " " + target + " HTTP/1.1\r\nHost: localhost\r\n" + fields + "\r\n");
  }

  HttpServer server_{{{"GET", "/", named("root")},
                      {"POST", "/v1/remesh", named("remesh"), [](const RequestHead&) { return Admission{77}; }},
                      {"GET", "/v1/requests/{id}", named("show")},
                      {"DELETE", "/v1/requests/{id}", named("cancel")},
                      {"GET", "/v1/requests/{id}/events", named("follow")},
                      {"GET", "/a.b+c", named("signs")},
                      {"GET", "/forged", with_forged_fields},
                      {"GET", "/pieces", in_pieces},
                      {"GET", "/large", large},
                      {"GET", "/nothing", [](const Call&) { return Response(); }}},
                     HttpSettings{}};
};

TEST_F(http_server, method_and_path_find_their_handler) {
  EXPECT_EQ(request("GET", "/").body, "root::");
  EXPECT_EQ(post(server_.port(), "/v1/remesh?a=b", "mesh").body, "remesh::mesh");
  EXPECT_EQ(request("GET", "/v1/requests/abc").body, "show:abc:");
  EXPECT_EQ(request("DELETE", "/v1/requests/abc").body, "cancel:abc:");
  EXPECT_EQ(request("GET", "/v1/requests/abc/events").body, "follow:abc:");
  EXPECT_EQ(request("GET", "/a.b+c").body, "signs::");
  EXPECT_EQ(request("GET", "http://host/v1/requests/abc?x#y").body, "show:abc:");
}

TEST_F(http_server, a_parameter_comes_as_the_bytes_that_were_meant) {
  EXPECT_EQ(request("GET", "/v1/requests/%61%25%3f+%20%23%c3%a4").body, "show:a%?+ #\xc3\xa4:");
  EXPECT_EQ(request("GET", "/v1/requests/%25u0041%2541").body, "show:%u0041%41:");
  EXPECT_EQ(request("GET", "/v1/requests/a%0d%0aX-Forged:%201").body, "show:a\r\nX-Forged: 1:");
}

TEST_F(http_server, other_paths_are_not_found) {
  for (const char* path : {"/v1", "/v1/remesh/", "/v1/remeshx", "/v1/requests", "/v1/requests/", "/v1/requests//events",
                           "//", "/v1/requests/a/b", "/v1/requests/a%2fb", "/axb+c", "/a.bbc"}) {
    const Answer answer = request("GET", path);
    EXPECT_EQ(answer.status, 404) << path;
    EXPECT_EQ(answer.header("Content-Type"), "application/problem+json") << path;
  }
  for (const char* method : {"POST", "PUT", "PATCH", "DELETE", "OPTIONS"}) {
    EXPECT_EQ(request(method, "/v1", "Content-Length: 0\r\n").status, 404) << method;
  }
  // The path is far longer than the regular expressions of the library could stand.
  EXPECT_EQ(request("GET", "/v1/requests/" + std::string(30'000, 'a')).status, 404);
}

TEST_F(http_server, other_methods_are_told_what_is_allowed) {
  EXPECT_EQ(request("GET", "/v1/remesh").status, 405);
  EXPECT_EQ(request("GET", "/v1/remesh").header("Allow"), "POST, OPTIONS");
  EXPECT_EQ(request("HEAD", "/v1/remesh").status, 405);
  for (const char* method : {"POST", "PUT", "PATCH"}) {
    const Answer answer = request(method, "/v1/requests/abc", "Content-Length: 0\r\n");
    EXPECT_EQ(answer.status, 405) << method;
    EXPECT_EQ(answer.header("Allow"), "GET, HEAD, DELETE, OPTIONS") << method;
    EXPECT_EQ(answer.header("Content-Type"), "application/problem+json") << method;
  }
  EXPECT_EQ(request("PUT", "/v1/remesh").status, 405) << "no length is no matter where the method is wrong";
  for (const char* method : {"TRACE", "CONNECT", "PRI", "get", "BREW"}) {
    EXPECT_EQ(request(method, "/").status, 501) << method;
  }
}

TEST_F(http_server, options_has_no_body_and_says_what_is_allowed) {
  const Answer answer = request("OPTIONS", "/v1/requests/abc", "Connection: close\r\n");
  EXPECT_EQ(answer.status, 204);
  EXPECT_EQ(answer.header("Allow"), "GET, HEAD, DELETE, OPTIONS");
  EXPECT_EQ(answer.header("Content-Length"), "");
  EXPECT_EQ(answer.body, "");
  EXPECT_EQ(request("OPTIONS", "*").header("Allow"), "OPTIONS");
}

TEST_F(http_server, head_answers_as_get_without_the_body) {
  const Answer answer = request("HEAD", "/v1/requests/abc", "Connection: close\r\n");
  EXPECT_EQ(answer.status, 200);
  EXPECT_EQ(answer.header("Content-Length"), "9");
  EXPECT_EQ(answer.header("Accept-Ranges"), "");
  EXPECT_EQ(answer.body, "");
  EXPECT_EQ(request("HEAD", "/pieces").body, "");
  EXPECT_EQ(request("HEAD", "/v1").body, "");
}

TEST_F(http_server, head_gets_no_body_whatever_is_wrong_with_it) {
  const std::string host = " HTTP/1.1\r\nHost: localhost\r\n";
  const std::string long_field = "A: " + std::string(40'000, 'b') + "\r\n\r\n";
  for (const auto& [text, status] : std::vector<std::pair<std::string, int>>{
           {"HEAD /%zz" + host + "\r\n", 400},
           {"HEAD *" + host + "\r\n", 400},
           {"HEAD / HTTP/1.1\r\n\r\n", 400},
           {"HEAD / HTTP/2.0\r\nHost: localhost\r\n\r\n", 505},
           {"HEAD /" + host + "A: \x01\r\n\r\n", 400},
           {"HEAD /" + host + "Content-Length: x\r\n\r\n", 400},
           {"HEAD /" + std::string(40'000, 'b') + host + "\r\n", 414},
           {"HEAD /" + host + long_field, 431},
       }) {
    const Answer answer = ask(server_.port(), text);
    EXPECT_EQ(answer.status, status) << text;
    EXPECT_EQ(answer.header("Content-Type"), "application/problem+json") << text;
    EXPECT_EQ(answer.body, "") << text;
  }
}

TEST_F(http_server, a_refusal_carries_the_id_that_was_read_before_it) {
  const Answer answer = ask(server_.port(), "GET / HTTP/1.1\r\nX-Request-Id: a-name-of-my-own\r\n\r\n");
  EXPECT_EQ(answer.status, 400);
  EXPECT_EQ(answer.header("X-Request-Id"), "a-name-of-my-own");
}

TEST_F(http_server, only_a_route_that_says_so_takes_a_body) {
  EXPECT_EQ(post(server_.port(), "/v1/remesh", std::string(77, 'x')).status, 200);
  EXPECT_EQ(post(server_.port(), "/v1/remesh", std::string(78, 'x')).status, 413);
  EXPECT_EQ(request("GET", "/", "Content-Length: 1\r\n").status, 413);
  EXPECT_EQ(request("OPTIONS", "/", "Content-Length: 1\r\n").status, 413);
  EXPECT_EQ(request("POST", "/v1", "Content-Length: 1\r\n").status, 404) << "without waiting for the body";
}

TEST_F(http_server, a_value_cannot_start_a_field_of_its_own) {
  const Answer answer = request("GET", "/forged");
  EXPECT_EQ(answer.status, 200);
  EXPECT_EQ(answer.header("Content-Disposition"), "a  Set-Cookie: x= y");
  EXPECT_EQ(answer.header("Set-Cookie"), "");
  EXPECT_EQ(answer.header("X-Forged"), "");
  EXPECT_EQ(answer.header("Content-Type"), "text/plain  X-Forged: 1");
  for (const char* id : {"a%0d%0ab", "abcdefgh-12345678\rX-Forged: 1"}) {
    const Answer other = request("GET", "/", std::string("X-Request-Id: ") + id + "\r\n");
    EXPECT_EQ(other.header("X-Request-Id").size(), 32u) << id;
    EXPECT_EQ(other.header("X-Forged"), "") << id;
  }
}

TEST_F(http_server, what_a_client_may_ask_of_the_library_is_not_heard) {
  // The HTTP library itself knows ranges, compression, and times of its own for connections.
  const Answer answer = request("GET", "/v1/requests/abc",
                                "Range: bytes=0-1\r\nAccept-Encoding: gzip, br\r\n"
                                "Expect: 100-continue\r\nREMOTE_ADDR: 1.2.3.4\r\n");
  EXPECT_EQ(answer.status, 200);
  EXPECT_EQ(answer.body, "show:abc:");
  EXPECT_EQ(answer.header("Content-Encoding"), "");
}

TEST_F(http_server, a_form_is_a_body_like_any_other) {
  for (const char* type : {"application/x-www-form-urlencoded", "multipart/form-data; boundary=x"}) {
    const Answer answer = post(server_.port(), "/v1/remesh", "a=b&c", std::string("Content-Type: ") + type + "\r\n");
    EXPECT_EQ(answer.body, "remesh::a=b&c") << type;
  }
}

TEST_F(http_server, every_answer_has_the_common_fields_once) {
  for (const Answer& answer : {request("GET", "/"), request("GET", "/v1"), request("OPTIONS", "/"),
                               request("GET", "/pieces"), request("rub bish", "/"), request("GET", "/nothing")}) {
    for (const std::string name : {"Date", "X-Request-Id", "X-Content-Type-Options", "Connection"}) {
      EXPECT_FALSE(answer.header(name).empty()) << name << "\n" << answer.head;
      const std::size_t first = answer.head.find("\r\n" + name + ": ");
      EXPECT_EQ(answer.head.find("\r\n" + name + ": ", first + 1), std::string::npos) << answer.head;
    }
  }
  EXPECT_EQ(request("GET", "/nothing").header("Content-Length"), "0");
}

TEST_F(http_server, a_body_in_pieces_ends_with_its_connection) {
  const Answer answer = request("GET", "/pieces");
  EXPECT_EQ(answer.body, "piece piece piece ");
  EXPECT_EQ(answer.header("Content-Type"), "text/event-stream");
  EXPECT_EQ(answer.header("Content-Length"), "");
  EXPECT_EQ(answer.head.find("\r\nContent-Type"), answer.head.rfind("\r\nContent-Type"));
}

TEST_F(http_server, a_small_answer_comes_in_one_packet_and_pieces_when_they_are_made) {
  const auto packets_of = [&](const std::string& path, std::string_view end) {
    RawClient client(server_.port());
    client.send("GET " + path + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
    EXPECT_NE(client.receive(end).find(end), std::string::npos);
    return data_segments_received(client.socket());
  };
  EXPECT_EQ(packets_of("/", "root::"), 1u);
  EXPECT_GE(packets_of("/pieces", "piece piece piece "), 3u);
}

TEST_F(http_server, a_client_that_leaves_in_the_middle_leaves_nothing_behind) {
  for (const char* begun :
       {"GET /large HTTP/1.1\r\nHost: localhost\r\n\r\n", "GET /pieces HTTP/1.1\r\nHost: localhost\r\n\r\n",
        "POST /v1/remesh HTTP/1.1\r\nHost: localhost\r\nContent-Length: 50\r\n\r\nx"}) {
    RawClient client(server_.port());
    client.send(begun);
    ASSERT_TRUE(eventually([&] { return server_.active_requests() == 1 || begun[5] == 'p'; })) << begun;
    client.close();
    EXPECT_TRUE(eventually([&] { return server_.active_requests() == 0; })) << begun;
    EXPECT_EQ(request("GET", "/").status, 200) << begun;
  }
  EXPECT_EQ(request("GET", "/large").body.size(), 30'000'000u);
}

/// Connections that serve more than one request.
class kept_connection : public http_server {
 protected:
  static std::string get_text(const std::string& path, const std::string& fields = "") {
    return "GET " + path + " HTTP/1.1\r\nHost: localhost\r\n" + fields + "\r\n";
  }
  /// Returns whether the server closes the connection without sending anything more.
  static bool is_closed(RawClient& client) { return client.receive().empty() && client.is_ended(); }

  static std::unique_ptr<HttpServer> start(const HttpSettings& settings) {
    const std::vector<Route> routes{{"GET", "/", named("root")}};
    auto server = std::make_unique<HttpServer>(routes, settings);
    server->bind({"127.0.0.1", 0});
    server->start();
    return server;
  }
};

TEST_F(kept_connection, requests_are_answered_one_after_another) {
  RawClient client(server_.port());
  for (int i = 0; i < 20; ++i) {
    const std::string name = std::to_string(i);
    client.send(get_text("/v1/requests/" + name));
    const Answer answer = client.answer();
    EXPECT_EQ(answer.body, "show:" + name + ":");
    EXPECT_EQ(answer.header("Connection"), "keep-alive");
    EXPECT_EQ(answer.header("Keep-Alive"), "timeout=120");
    client.send(post_text("/v1/remesh", name));
    EXPECT_EQ(client.answer().body, "remesh::" + name);
  }
  EXPECT_TRUE(eventually([&] { return server_.open_connections() == 1; }));
}

TEST_F(kept_connection, what_is_sent_ahead_is_not_lost_wherever_the_packets_end) {
  const std::string requests =
      post_text("/v1/remesh", "one") +
      "POST /v1/remesh HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n3\r\ntwo\r\n0\r\nT: t\r\n\r\n" +
      get_text("/nothing") + get_text("/v1/requests/four", "Connection: close\r\n");
  for (const std::size_t size : {requests.size(), std::size_t{1}, std::size_t{7}, std::size_t{97}}) {
    RawClient client(server_.port());
    for (std::size_t at = 0; at < requests.size(); at += size) ASSERT_TRUE(client.send(requests.substr(at, size)));
    EXPECT_EQ(client.answer().body, "remesh::one") << size;
    EXPECT_EQ(client.answer().body, "remesh::two") << size;
    EXPECT_EQ(client.answer().body, "") << size;
    EXPECT_EQ(client.answer().body, "show:four:") << size;
    EXPECT_TRUE(is_closed(client)) << size;
  }
}

TEST_F(kept_connection, it_ends_where_the_client_says_so_or_the_next_request_cannot_be_told) {
  for (const std::string& request :
       {get_text("/", "Connection: close\r\n"), get_text("/", "Connection: keep-alive\r\nConnection: close\r\n"),
        std::string("GET / HTTP/1.0\r\n\r\n"), get_text("/pieces"), get_text("/", "Content-Length: 3\r\n") + "abc",
        get_text("/v1"), get_text("/v1/remesh"), post_text("/v1/remesh", std::string(78, 'x')),
        std::string("rubbish\r\n\r\n")}) {
    RawClient client(server_.port());
    client.send(request + get_text("/"));
    const std::string received = client.receive();
    const Answer answer = Answer::parse(received);
    EXPECT_NE(answer.status, 0) << request;
    EXPECT_EQ(answer.header("Connection"), "close") << request;
    EXPECT_EQ(answer.header("Keep-Alive"), "") << request;
    EXPECT_EQ(received.find("HTTP/1.1 ", 1), std::string::npos) << request << ": a second answer";
  }
}

TEST_F(kept_connection, behind_an_answer_without_a_body_comes_the_next_one) {
  RawClient client(server_.port());
  const std::string end = "\r\n\r\n";
  for (const std::string method : {"HEAD", "OPTIONS"}) {
    client.send(method + " /v1/requests/abc HTTP/1.1\r\nHost: localhost\r\n\r\n");
    const std::string head = client.receive(end);
    EXPECT_EQ(head.find(end) + end.size(), head.size()) << method;
    EXPECT_EQ(Answer::parse(head).header("Connection"), "keep-alive") << method;
    EXPECT_EQ(Answer::parse(head).header("Content-Length"), method == "HEAD" ? "9" : "") << method;
    client.send(get_text("/v1/requests/abc"));
    EXPECT_EQ(client.answer().body, "show:abc:") << method;
  }
}

TEST_F(kept_connection, a_line_end_behind_a_body_is_no_request) {
  for (const bool is_late : {false, true}) {
    RawClient client(server_.port());
    client.send(post_text("/v1/remesh", "one") + (is_late ? "" : "\r\n"));
    EXPECT_EQ(client.answer().body, "remesh::one");
    if (is_late) client.send("\r\n");
    client.send(get_text("/v1/requests/two"));
    EXPECT_EQ(client.answer().body, "show:two:") << is_late;
  }
  // The same holds if the next request arrives in one piece with it, as it is put back.
  RawClient client(server_.port());
  client.send(get_text("/") + "\r\n" + get_text("/v1/requests/two", "Connection: close\r\n"));
  EXPECT_EQ(client.answer().body, "root::");
  EXPECT_EQ(client.answer().body, "show:two:");
}

TEST_F(kept_connection, before_http_1_1_it_is_kept_where_the_client_asks) {
  RawClient client(server_.port());
  for (int i = 0; i < 2; ++i) {
    client.send("GET / HTTP/1.0\r\nConnection: Keep-Alive\r\n\r\n");
    const Answer answer = client.answer();
    EXPECT_EQ(answer.status, 200);
    EXPECT_EQ(answer.header("Connection"), "keep-alive");
  }
}

TEST_F(kept_connection, it_waits_so_long_and_no_longer) {
  HttpSettings settings;
  settings.connections.idle_timeout = std::chrono::milliseconds(100);
  const auto server = start(settings);
  RawClient client(server->port());
  client.send(get_text("/"));
  const auto began = Clock::now();
  EXPECT_EQ(client.answer().status, 200);
  EXPECT_TRUE(is_closed(client));
  EXPECT_GE(Clock::now() - began, std::chrono::milliseconds(100));

  settings.connections.idle_timeout = std::chrono::milliseconds(0);
  const auto other = start(settings);
  RawClient once(other->port());
  once.send(get_text("/"));
  EXPECT_EQ(once.answer().header("Connection"), "close");
  EXPECT_TRUE(is_closed(once));
}

TEST_F(kept_connection, those_that_wait_take_no_place_of_others) {
  HttpSettings settings;
  settings.connections.max_connections = settings.connections.max_connections_per_address = 4;
  settings.connections.idle_timeout = 2 * kPatience;
  const auto server = start(settings);
  std::vector<std::unique_ptr<RawClient>> clients;
  for (int i = 0; i < 20; ++i) {
    clients.push_back(std::make_unique<RawClient>(server->port()));
    clients.back()->send(get_text("/"));
    ASSERT_EQ(clients.back()->answer().status, 200) << i;
    // Those that waited longest have gone.
    ASSERT_TRUE(eventually([&] { return server->open_connections() <= 4; })) << i;
  }
  EXPECT_TRUE(is_closed(*clients.front()));
  for (int again = 0; again < 2; ++again) {
    clients.back()->send(get_text("/"));
    EXPECT_EQ(clients.back()->answer().status, 200);
  }
}

TEST_F(kept_connection, those_that_wait_stay_while_there_are_free_places) {
  HttpSettings settings;
  settings.connections.max_connections = settings.connections.max_connections_per_address = 4;
  const auto server = start(settings);
  std::vector<std::unique_ptr<RawClient>> clients;
  const auto add_one = [&] {
    clients.push_back(std::make_unique<RawClient>(server->port()));
    clients.back()->send(get_text("/"));
    EXPECT_EQ(clients.back()->answer().status, 200);
    ASSERT_TRUE(eventually([&] { return server->open_connections() <= 4; }));
  };
  for (int i = 0; i < 4; ++i) add_one();
  EXPECT_TRUE(eventually([&] { return server->open_connections() == 4; }));
  for (const auto& client : clients) EXPECT_FALSE(client->has_input());
  add_one();
  // A client has its answer before the server counts it among those that wait. So it may be the second client that has
  // waited longest.
  const auto is_ended = [](const auto& client) { return client->has_input(); };
  EXPECT_TRUE(eventually([&] { return std::any_of(clients.begin(), clients.end(), is_ended); }));
  EXPECT_EQ(std::count_if(clients.begin(), clients.end(), is_ended), 1);
  EXPECT_FALSE(is_ended(clients.back()));
}

TEST_F(kept_connection, clients_are_told_less_than_the_time_in_force) {
  HttpSettings settings;
  EXPECT_EQ(settings.connections.idle_timeout, std::chrono::seconds(150));
  RawClient client(server_.port());
  client.send(get_text("/"));
  EXPECT_EQ(client.answer().header("Keep-Alive"), "timeout=120");
  settings.connections.idle_timeout = std::chrono::seconds(1);
  const auto server = start(settings);
  RawClient other(server->port());
  other.send(get_text("/"));
  EXPECT_EQ(other.answer().header("Keep-Alive"), "");
}

TEST_F(kept_connection, a_drain_ends_those_that_wait_and_those_that_come) {
  HttpSettings settings;
  settings.connections.idle_timeout = 2 * kPatience;  // so that it is the drain that ends them
  const auto server = start(settings);
  RawClient waiting(server->port());
  waiting.send(get_text("/"));
  EXPECT_EQ(waiting.answer().header("Connection"), "keep-alive");
  server->begin_drain();
  EXPECT_TRUE(is_closed(waiting));
  RawClient client(server->port());
  client.send(get_text("/"));
  EXPECT_EQ(client.answer().header("Connection"), "close");
  EXPECT_TRUE(is_closed(client));
}

TEST_F(kept_connection, a_thread_stays_for_the_next_one) {
  std::mutex mutex;
  std::set<pid_t> threads;  // the system's: those of the library are used again at once
  HttpServer server({{"GET", "/",
                      [&](const Call&) {
                        const std::lock_guard lock(mutex);
                        threads.insert(::gettid());
                        return Response();
                      }}},
                    HttpSettings{});
  server.bind({"127.0.0.1", 0});
  server.start();
  for (int i = 0; i < 50; ++i) {
    RawClient client(server.port());
    client.send(get_text("/", "Connection: close\r\n"));
    EXPECT_EQ(client.answer().status, 200);
    EXPECT_TRUE(is_closed(client));
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  server.stop();
  EXPECT_LT(threads.size(), 25u);
}

TEST(http_server_routes, a_method_that_cannot_be_routed_is_a_defect_that_shows_at_once) {
  const auto make = [] { HttpServer server({{"BREW", "/", named("tea")}}, HttpSettings{}); };
  EXPECT_THROW(make(), std::logic_error);
}

}  // namespace
}  // namespace remesh::server
