/// Tests who may send requests: keys, origins, addresses.
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <thread>
#include <vector>

#include "server/http/address_counts.h"
#include "server/http/api_keys.h"
#include "server/http/cors.h"
#include "server/http/key_limits.h"
#include "tests/server/stub_daemon.h"

namespace remesh::server {
namespace {

const std::string kKey = "0123456789abcdef-key";
const std::string kOtherKey = "fedcba9876543210-key";

/// A file that is removed with the test.
class KeyFile {
 public:
  explicit KeyFile(const std::string& text)
      : path_(::testing::TempDir() + "remeshd_keys_" + std::to_string(::getpid()) + "_" +
              ::testing::UnitTest::GetInstance()->current_test_info()->name()) {
    write(text);
  }
  ~KeyFile() { std::remove(path_.c_str()); }
  void write(const std::string& text) const { std::ofstream(path_) << text; }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

RequestHead with_header(const std::string& name, const std::string& value) {
  RequestHead head;
  head.headers.emplace_back(name, value);
  return head;
}

TEST(api_keys, without_any_all_are_admitted) {
  const ApiKeys keys("", "");
  EXPECT_TRUE(keys.is_open());
  EXPECT_TRUE(keys.admits(RequestHead()));
}

TEST(api_keys, a_key_is_shown_as_bearer_or_in_a_field_of_its_own) {
  const ApiKeys keys("", kKey);
  EXPECT_TRUE(keys.admits(with_header("authorization", "Bearer " + kKey)));
  EXPECT_TRUE(keys.admits(with_header("authorization", "bearer  " + kKey)));
  EXPECT_TRUE(keys.admits(with_header("x-api-key", kKey)));
  for (const std::string& wrong : {std::string(), kOtherKey, kKey + "x", kKey.substr(1), "Basic " + kKey}) {
    EXPECT_FALSE(keys.admits(with_header("x-api-key", wrong))) << wrong;
    EXPECT_FALSE(keys.admits(with_header("authorization", wrong))) << wrong;
    EXPECT_FALSE(keys.admits(with_header("authorization", "Bearer " + wrong))) << wrong;
  }
  EXPECT_FALSE(keys.admits(RequestHead()));
}

TEST(api_keys, a_file_is_read_again_and_all_its_keys_are_refused_where_it_is_wrong) {
  const KeyFile file("# the first\n\n  " + kKey + "\r\n");
  const std::string fixed = "the-key-of-the-environment";
  ApiKeys keys(file.path(), fixed);
  EXPECT_EQ(keys.count(), 2u);
  EXPECT_TRUE(keys.admits(with_header("x-api-key", kKey)));
  file.write(kOtherKey + "\n");
  keys.reload();
  EXPECT_FALSE(keys.admits(with_header("x-api-key", kKey)));
  EXPECT_TRUE(keys.admits(with_header("x-api-key", kOtherKey)));
  for (const char* bad : {"", "# nothing\n", "short\n", "0123456789 abcdefghij\n"}) {
    file.write(bad);
    EXPECT_THROW(keys.reload(), std::invalid_argument) << bad;
    EXPECT_FALSE(keys.admits(with_header("x-api-key", kOtherKey)));
    EXPECT_TRUE(keys.admits(with_header("x-api-key", fixed)));
    EXPECT_FALSE(keys.is_open());
    EXPECT_FALSE(keys.has_owner(keys.owner(with_header("x-api-key", kOtherKey))));
  }
  file.write(kOtherKey + "\n");
  keys.reload();
  EXPECT_TRUE(keys.has_owner(keys.owner(with_header("x-api-key", kOtherKey))));
}

TEST(api_keys, a_line_may_name_its_key_and_else_has_its_number) {
  const KeyFile file("# keys\nanna-2.b \t " + kKey + "\n\n" + kOtherKey + "\n");
  const ApiKeys keys(file.path(), "the-key-of-the-environment");
  const auto name_of = [&](const std::string& key) { return keys.name_of(keys.owner(with_header("x-api-key", key))); };
  EXPECT_EQ(name_of(kKey), "anna-2.b");
  EXPECT_EQ(name_of(kOtherKey), "4");
  EXPECT_EQ(name_of("the-key-of-the-environment"), "environment");
  EXPECT_EQ(name_of("anna-2.b " + kKey), "");
  EXPECT_EQ(keys.owner(with_header("x-api-key", kKey)), ApiKeys("", kKey).owner(with_header("x-api-key", kKey)))
      << "jobs stay those of the key when it gets a name";
}

TEST(api_keys, a_name_that_could_be_something_else_is_an_error) {
  for (const std::string& name : {std::string("4"), std::string("a/b"), std::string("-"), std::string("\xc3\xa4"),
                                  std::string("a\"b"), std::string(65, 'a')}) {
    const KeyFile file(kOtherKey + "\n" + name + " " + kKey + "\n");
    try {
      ApiKeys(file.path(), "");
      FAIL() << name;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find("line 2 "), std::string::npos) << error.what();
      EXPECT_EQ(std::string(error.what()).find(kKey), std::string::npos) << "no key is shown";
    }
  }
}

TEST(key_limits, a_minute_gives_as_many_requests_as_are_allowed_and_others_have_their_own) {
  KeyLimits limits({.max_running = 0, .max_rate = 6});
  const auto start = KeyLimits::Clock::now();
  const auto is_let_in = [&](const std::string& owner, int seconds) {
    try {
      limits.enter(owner, start + std::chrono::seconds(seconds));
      return true;
    } catch (const HttpError& error) {
      EXPECT_EQ(error.problem.status, 429);
      EXPECT_EQ(error.problem.code, "rate_limited");
      EXPECT_EQ(error.problem.limit, 6u);
      return false;
    }
  };
  for (int i = 0; i < 6; ++i) EXPECT_TRUE(is_let_in("many", 0));
  EXPECT_FALSE(is_let_in("many", 9));
  EXPECT_TRUE(is_let_in("many", 10)) << "one in ten seconds";
  EXPECT_FALSE(is_let_in("many", 10));
  EXPECT_TRUE(is_let_in("few", 10));
  int let_in = 0;
  for (int i = 0; i < 20; ++i) let_in += is_let_in("many", 1000) ? 1 : 0;
  EXPECT_EQ(let_in, 6) << "no more is saved than for a minute";
  // The refusal tells when the next one is let in.
  try {
    limits.enter("many", start + std::chrono::seconds(1003));
    FAIL();
  } catch (const HttpError& error) {
    EXPECT_EQ(error.headers, (Fields{{"Retry-After", "7"}}));
  }
  EXPECT_TRUE(is_let_in("many", 1010));
}

TEST(key_limits, as_many_requests_as_are_allowed_run_at_once) {
  KeyLimits limits({.max_running = 2, .max_rate = 3});
  const auto now = KeyLimits::Clock::now();
  {
    const auto first = limits.enter("many", now), second = limits.enter("many", now);
    EXPECT_THROW(limits.enter("many", now), HttpError);
    EXPECT_NO_THROW(limits.enter("few", now));
  }
  EXPECT_NO_THROW(limits.enter("many", now)) << "what found no place did not count for the rate";
  EXPECT_THROW(limits.enter("many", now), HttpError);
}

TEST(api_keys, requests_are_compared_while_the_file_is_read_again) {
  // If keys were freed too early, at least a sanitizer would find it.
  const KeyFile file(kKey + "\n");
  ApiKeys keys(file.path(), "");
  std::atomic<bool> goes_on = true;
  std::vector<std::thread> askers;
  for (int i = 0; i < 3; ++i) {
    askers.emplace_back([&] {
      while (goes_on) EXPECT_TRUE(keys.admits(with_header("x-api-key", kKey)));
    });
  }
  for (int i = 0; i < 300; ++i) keys.reload();
  goes_on = false;
  for (std::thread& asker : askers) asker.join();
}

TEST(api_keys, a_token_is_valid_for_its_path_and_time) {
  const KeyFile file(kKey + "\n" + kOtherKey + "\n");
  const ApiKeys keys(file.path(), "");
  const RequestHead mine = with_header("x-api-key", kOtherKey);
  const auto now = std::chrono::system_clock::now();
  const std::string token = keys.token(mine, "/v1/jobs/1/events", now);
  EXPECT_EQ(keys.owner_by_token(token, "/v1/jobs/1/events", now), keys.owner(mine));
  EXPECT_EQ(ApiKeys("", kOtherKey).owner_by_token(token, "/v1/jobs/1/events", now), keys.owner(mine))
      << "another daemon";
  EXPECT_FALSE(keys.owner_by_token(token, "/v1/jobs/2/events", now));
  EXPECT_FALSE(keys.owner_by_token(token, "/v1/jobs/1/events", now + ApiKeys::kTokenLife + std::chrono::seconds(1)));
  EXPECT_FALSE(ApiKeys("", kKey).owner_by_token(token, "/v1/jobs/1/events", now));
  const std::string later = "9" + token;  // the time is part of what is signed
  for (const std::string& wrong : {std::string(), std::string("."), token.substr(1), later, token + "0", "-" + token})
    EXPECT_FALSE(keys.owner_by_token(wrong, "/v1/jobs/1/events", now)) << wrong;
  EXPECT_EQ(ApiKeys("", "").token(mine, "/", now), "");
}

TEST(api_keys, a_missing_file_and_a_short_key_are_errors) {
  EXPECT_THROW(ApiKeys("/nowhere/keys", ""), std::invalid_argument);
  EXPECT_THROW(ApiKeys("", "short"), std::invalid_argument);
}

std::string value_of(const Fields& fields, const std::string& name) {
  for (const auto& [key, value] : fields) {
    if (key == name) return value;
  }
  return "";
}

TEST(cors, no_page_may_unless_it_is_listed) {
  const RequestHead head = with_header("origin", "https://tool.example");
  EXPECT_TRUE(Cors().headers(head).empty());
  const Cors cors("https://other.example, https://tool.example");
  EXPECT_EQ(value_of(cors.headers(head), "Access-Control-Allow-Origin"), "https://tool.example");
  EXPECT_EQ(value_of(cors.headers(head), "Vary"), "Origin");
  const Fields stranger = cors.headers(with_header("origin", "https://evil.example"));
  EXPECT_EQ(value_of(stranger, "Access-Control-Allow-Origin"), "");
  EXPECT_EQ(value_of(stranger, "Vary"), "Origin");
  EXPECT_EQ(value_of(Cors("*").headers(head), "Access-Control-Allow-Origin"), "*");
}

TEST(cors, what_is_no_origin_is_an_error) {
  for (const char* bad : {"tool.example", "https://", "https://tool.example/path", "null"})
    EXPECT_THROW(Cors{bad}, std::invalid_argument) << bad;
}

TEST(address_counts, each_address_has_its_own_places) {
  AddressCounts counts(2);
  auto first = counts.enter("10.0.0.1");
  const auto second = counts.enter("10.0.0.1");
  EXPECT_TRUE(first && second);
  EXPECT_FALSE(counts.enter("10.0.0.1"));
  EXPECT_TRUE(counts.enter("10.0.0.2"));
  first.reset();
  EXPECT_TRUE(counts.enter("10.0.0.1"));
}

TEST(address_counts, a_client_is_an_ipv4_address_or_an_ipv6_network) {
  EXPECT_EQ(client_key("::ffff:10.0.0.1"), client_key("10.0.0.1"));
  EXPECT_EQ(client_key("2001:db8:1:2:aaaa::1"), client_key("2001:db8:1:2:bbbb::2"));
  EXPECT_NE(client_key("2001:db8:1:2::1"), client_key("2001:db8:1:3::1"));
}

using access = StubDaemon;

TEST_F(access, with_a_key_only_the_page_and_the_probes_are_open) {
  config_.api_key = kKey;
  start();
  for (const char* path : {"/", "/livez", "/readyz"}) EXPECT_EQ(get(port_, path).status, 200) << path;
  for (const char* path : {"/metrics", "/openapi.json", "/v1/capabilities", "/v1/requests/0123456789abcdef"}) {
    const Answer answer = get(port_, path);
    EXPECT_EQ(answer.status, 401) << path;
    EXPECT_EQ(code_of(answer), "unauthorized");
    EXPECT_EQ(answer.header("WWW-Authenticate"), "Bearer");
  }
  EXPECT_EQ(post(port_, "/v1/remesh", "good", "X-API-Key: " + kKey + "\r\n").status, 200);
  EXPECT_EQ(post(port_, "/v1/remesh", "good", "Authorization: Bearer " + kKey + "\r\n").status, 200);
}

TEST_F(access, without_the_key_no_byte_of_a_body_is_read) {
  config_.api_key = kKey;
  start();
  RawClient client(port_);
  client.send("POST /v1/remesh HTTP/1.1\r\nHost: localhost\r\nContent-Length: 500\r\nExpect: 100-continue\r\n\r\n");
  EXPECT_EQ(client.answer().status, 401);
}

TEST_F(access, a_running_request_belongs_to_the_key_that_sent_it) {
  const KeyFile file(kKey + "\n" + kOtherKey + "\n");
  config_.api_key_file = file.path();
  start();
  const std::string mine = "X-API-Key: " + kKey + "\r\n";
  const auto client = start_blocking(kIdField + mine);
  const auto ask_as = [&](const std::string& key, const std::string& method, const std::string& rest) {
    return ask(port_, method + " /v1/requests/" + kId + rest + " HTTP/1.1\r\nHost: localhost\r\nX-API-Key: " + key +
                          "\r\n\r\n")
        .status;
  };
  EXPECT_EQ(ask_as(kOtherKey, "GET", ""), 404);
  EXPECT_EQ(ask_as(kOtherKey, "DELETE", ""), 404);
  EXPECT_EQ(ask_as(kOtherKey, "GET", "/events"), 404);
  EXPECT_EQ(stub_.stopped, 0);
  EXPECT_EQ(ask_as(kKey, "GET", ""), 200);
  EXPECT_EQ(ask_as(kKey, "DELETE", ""), 204);
  EXPECT_EQ(code_of(client->answer()), "cancelled");
}

TEST_F(access, a_key_that_is_taken_out_ends_the_streams_that_it_has_opened) {
  const KeyFile file(kKey + "\n" + kOtherKey + "\n");
  config_.api_key_file = file.path();
  start();
  const auto client = start_blocking(kIdField + "X-API-Key: " + kKey + "\r\n");
  RawClient follower(port_);
  follower.send("GET /v1/requests/" + kId + "/events HTTP/1.1\r\nHost: localhost\r\nX-API-Key: " + kKey + "\r\n\r\n");
  follower.receive("event: progress\ndata: {");
  file.write(kOtherKey + "\n");
  daemon_->reload_keys();
  // The request still runs, so the stream would go on.
  const std::string rest = follower.receive();
  EXPECT_EQ(rest.find("event: end"), std::string::npos) << rest;
  EXPECT_EQ(stub_.stopped, 0);
}

TEST_F(access, a_key_has_its_limits_and_what_needs_no_work_has_none) {
  const KeyFile file("many " + kKey + "\nfew " + kOtherKey + "\n");
  config_.api_key_file = file.path();
  config_.key_rules.max_running = 1;
  start();
  const std::string many = "X-API-Key: " + kKey + "\r\n";
  const auto client = start_blocking(kIdField + many);
  const Answer refused = post(port_, "/v1/remesh", "good", many);
  EXPECT_EQ(refused.status, 429);
  EXPECT_EQ(code_of(refused), "rate_limited");
  EXPECT_GT(std::stoi(refused.header("Retry-After")), 0);
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(ask(port_, "GET /v1/capabilities HTTP/1.1\r\nHost: localhost\r\n" + many + "\r\n").status, 200);
  EXPECT_NE(post(port_, "/v1/remesh", "good", "X-API-Key: " + kOtherKey + "\r\n").status, 429);
  stub_.released = true;
  EXPECT_EQ(client->answer().status, 200);
  EXPECT_TRUE(eventually([&] { return post(port_, "/v1/remesh", "good", many).status == 200; }));
}

TEST_F(access, the_operations_port_asks_for_no_key) {
  config_.api_key = kKey;
  config_.ops_bind = Address{"127.0.0.1", 0};
  start();
  for (const char* path : {"/livez", "/readyz", "/metrics"}) EXPECT_EQ(get(daemon_->ops_port(), path).status, 200);
  EXPECT_EQ(get(daemon_->ops_port(), "/v1/capabilities").status, 404);
}

TEST_F(access, a_page_of_an_allowed_origin_may_ask_and_see_errors) {
  config_.cors = Cors("https://tool.example");
  config_.api_key = kKey;
  start();
  const std::string origin = "Origin: https://tool.example\r\n";
  const Answer preflight =
      ask(port_,
          "OPTIONS /v1/remesh HTTP/1.1\r\nHost: localhost\r\nAccess-Control-Request-Method: POST\r\n"
          "Access-Control-Request-Headers: x-api-key\r\n" +
              origin + "\r\n");
  EXPECT_EQ(preflight.status, 204);
  EXPECT_EQ(preflight.header("Access-Control-Allow-Origin"), "https://tool.example");
  EXPECT_NE(preflight.header("Access-Control-Allow-Methods").find("POST"), std::string::npos);
  EXPECT_NE(preflight.header("Access-Control-Allow-Headers").find("X-API-Key"), std::string::npos);
  EXPECT_EQ(post(port_, "/v1/remesh", "good", origin).header("Access-Control-Allow-Origin"), "https://tool.example");
  EXPECT_EQ(post(port_, "/v1/remesh", "good", "Origin: https://evil.example\r\n").header("Access-Control-Allow-Origin"),
            "");
}

TEST_F(access, one_address_cannot_shut_out_another) {
  config_.connections.max_connections = 6;
  config_.connections.max_connections_per_address = 3;
  config_.connections.gate.head_timeout = std::chrono::minutes(5);
  start();
  std::vector<std::unique_ptr<RawClient>> hogs;
  for (int i = 0; i < 3; ++i) hogs.push_back(hold_connection());
  const Answer refused = get(port_, "/livez");
  EXPECT_EQ(refused.status, 429);
  EXPECT_EQ(code_of(refused), "rate_limited");
  EXPECT_FALSE(refused.header("Retry-After").empty());
  RawClient other(port_, "127.0.0.2");
  other.send("GET /livez HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_EQ(other.answer().status, 200);
}

/// Sends a request that waits for its body, from an address of this machine and with the fields of a proxy.
std::unique_ptr<RawClient> ask_through(int port, const char* from, const std::string& fields) {
  auto client = std::make_unique<RawClient>(port, from);
  client->send("POST /v1/remesh HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1\r\nExpect: 100-continue\r\n" + fields +
               "\r\n");
  return client;
}

TEST_F(access, each_client_behind_a_trusted_proxy_is_limited_by_itself) {
  config_.connections.max_connections_per_address = 2;
  config_.trusted_proxies = TrustedProxies("127.0.0.2");
  start();
  std::vector<std::unique_ptr<RawClient>> held;
  const auto is_taken = [&](const char* from, const std::string& fields) {
    held.push_back(ask_through(port_, from, fields));
    return held.back()->receive("\r\n\r\n") == "HTTP/1.1 100 Continue\r\n\r\n";
  };
  for (const char* client : {"9.9.9.1", "9.9.9.2", "9.9.9.3"}) {
    for (int i = 0; i < 2; ++i) EXPECT_TRUE(is_taken("127.0.0.2", "X-Forwarded-For: " + std::string(client) + "\r\n"));
    const Answer refused = ask_through(port_, "127.0.0.2", "Forwarded: for=" + std::string(client) + "\r\n")->answer();
    EXPECT_EQ(refused.status, 429) << client;
  }
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(is_taken("127.0.0.2", "")) << "the proxy itself has no limit";
}

TEST_F(access, from_others_the_fields_of_proxies_change_nothing) {
  config_.connections.max_connections_per_address = 2;
  config_.trusted_proxies = TrustedProxies("127.0.0.2");
  start();
  std::vector<std::unique_ptr<RawClient>> held;
  for (int i = 0; i < 2; ++i) {
    held.push_back(ask_through(port_, "127.0.0.3", "X-Forwarded-For: 9.9.9." + std::to_string(i) + "\r\n"));
    EXPECT_EQ(held.back()->receive("\r\n\r\n"), "HTTP/1.1 100 Continue\r\n\r\n");
  }
  EXPECT_EQ(ask_through(port_, "127.0.0.3", "X-Forwarded-For: 9.9.9.9\r\n")->answer().status, 429);
}

}  // namespace
}  // namespace remesh::server
