#include "server/http/site_rules.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "tests/server/stub_daemon.h"

namespace remesh::server {
namespace {

/// The status with which the rules answer; 200 if they let the request pass.
int status_of(const SiteRules& rules, const RequestHead& head, Access access = Access::kGuarded) {
  try {
    rules.check(head, access);
  } catch (const HttpError& error) {
    return error.problem.status;
  }
  return 200;
}

RequestHead head_of(const std::string& host, const Fields& fields = {}, const std::string& method = "POST") {
  RequestHead head;
  head.method = method;
  head.headers = fields;
  if (!host.empty()) head.headers.emplace_back("host", host);
  return head;
}

const SiteRules kLoopback({}, {}, {}, /*is_loopback=*/true);
const SiteRules kNetwork({}, {}, {}, /*is_loopback=*/false);

TEST(host_name, a_host_is_split_into_name_and_port) {
  EXPECT_EQ(parse_host("Mesh.Example.:8080").name, "mesh.example");
  EXPECT_EQ(parse_host("Mesh.Example.:8080").port, "8080");
  EXPECT_EQ(parse_host("[::1]:80").name, "[::1]");
  EXPECT_EQ(parse_host("[::1]:80").port, "80");
  EXPECT_EQ(parse_host("[::1]").port, "");
  EXPECT_EQ(parse_host("[::1").name, "[::1");
}

TEST(host_name, an_origin_and_a_host_are_compared_with_their_standard_ports) {
  EXPECT_TRUE(is_at(*parse_origin("http://a"), parse_host("a:80")));
  EXPECT_TRUE(is_at(*parse_origin("https://A:443"), parse_host("a")));
  EXPECT_TRUE(is_at(*parse_origin("http://[::1]:8080"), parse_host("[::1]:8080")));
  EXPECT_FALSE(is_at(*parse_origin("https://a"), parse_host("a:80")));
  EXPECT_FALSE(is_at(*parse_origin("http://a:8080"), parse_host("a")));
  for (const char* text : {"null", "", "a", "://a", "http://", "http://a/b", "http://a, http://b"})
    EXPECT_FALSE(parse_origin(text)) << text;
}

TEST(site_rules, a_name_that_may_be_another_sites_is_misdirected) {
  for (const char* host : {"evil.example", "evil.example:8080", "EVIL.example.", "localhost.evil.example",
                           "127.0.0.1.nip.io", "notlocalhost.example", "1.evil", "%65vil.example"}) {
    EXPECT_EQ(status_of(kLoopback, head_of(host)), 421) << host;
    EXPECT_EQ(status_of(kNetwork, head_of(host)), 421) << host;
  }
}

TEST(site_rules, what_is_no_host_is_malformed_although_it_begins_as_one_that_is_answered) {
  const SiteRules any(AllowedHosts("*"), {}, {}, true);
  for (const char* host :
       {"localhost:-1", "localhost:http", "localhost:65536", "localhost:000080", "[::1].evil.example",
        "[::1].evil.example:80", "[::1", "[evil.example]", "evil[::1]", "127.0.0.1:8080x"})
    for (const SiteRules* rules : {&kLoopback, &kNetwork, &any})
      EXPECT_EQ(status_of(*rules, head_of(host)), 400) << host;
  EXPECT_EQ(status_of(any, head_of("evil.example:8080")), 200);
}

TEST(site_rules, addresses_and_localhost_are_answered) {
  for (const char* host : {"127.0.0.1:8080", "[::1]:8080", "192.168.1.5", "localhost", "LOCALHOST:8080", "localhost.",
                           "a.localhost", "2130706433", "127.1", "0x7f.1", "", ":8080"}) {
    EXPECT_EQ(status_of(kLoopback, head_of(host)), 200) << host;
    EXPECT_EQ(status_of(kNetwork, head_of(host)), 200) << host;
  }
}

TEST(site_rules, a_name_without_a_dot_is_answered_unless_only_this_machine_can_ask) {
  for (const char* host : {"remeshd", "remeshd:8080", "my-machine"}) {
    EXPECT_EQ(status_of(kLoopback, head_of(host)), 421) << host;
    EXPECT_EQ(status_of(kNetwork, head_of(host)), 200) << host;
  }
}

TEST(site_rules, names_can_be_allowed) {
  const SiteRules rules(AllowedHosts("Mesh.example, remeshd"), {}, {}, true);
  for (const char* host : {"mesh.example:8080", "MESH.EXAMPLE", "remeshd"})
    EXPECT_EQ(status_of(rules, head_of(host)), 200) << host;
  for (const char* host : {"a.mesh.example", "mesh.example.org"})
    EXPECT_EQ(status_of(rules, head_of(host)), 421) << host;
  EXPECT_EQ(status_of(SiteRules(AllowedHosts("*"), {}, {}, true), head_of("evil.example")), 200);
  EXPECT_EQ(status_of(SiteRules({}, PublicUrl("https://mesh.example/x"), {}, true), head_of("mesh.example")), 200);
  for (const char* bad : {"mesh.example:8080", "http://mesh.example", "a b", "a/b", "[::1]", "."})
    EXPECT_THROW(AllowedHosts{bad}, std::invalid_argument) << bad;
}

TEST(site_rules, the_host_of_an_absolute_target_goes_before_the_field) {
  RequestHead head = head_of("localhost");
  head.target_authority = "evil.example";
  EXPECT_EQ(status_of(kLoopback, head), 421);
}

TEST(site_rules, probes_answer_to_every_name) {
  EXPECT_EQ(status_of(kLoopback, head_of("evil.example", {}, "GET"), Access::kProbe), 200);
  EXPECT_EQ(status_of(kLoopback, head_of("evil.example", {}, "GET"), Access::kPageFile), 421);
}

TEST(site_rules, what_the_browser_says_of_the_site_decides) {
  const auto status = [](const std::string& site, const std::string& origin) {
    return status_of(kLoopback, head_of("localhost:8080", {{"sec-fetch-site", site}, {"origin", origin}}));
  };
  for (const char* site : {"same-origin", "none"}) {
    EXPECT_EQ(status(site, "http://localhost:8080"), 200) << site;
    EXPECT_EQ(status(site, "https://a.proxy.example"), 200) << site;
  }
  for (const char* site : {"cross-site", "same-site", "new-word", "same-origin, none"}) {
    EXPECT_EQ(status(site, "http://localhost:8080"), 403) << site;
    EXPECT_EQ(status(site, ""), 403) << site;
  }
}

TEST(site_rules, an_origin_alone_must_be_the_servers_own) {
  const auto status = [](const SiteRules& rules, const std::string& origin) {
    return status_of(rules, head_of("localhost:8080", {{"origin", origin}}));
  };
  EXPECT_EQ(status(kLoopback, "http://localhost:8080"), 200);
  for (const char* origin :
       {"null", "", "https://evil.example", "http://localhost:3000", "http://127.0.0.1:8080", "http://localhost"})
    EXPECT_EQ(status(kLoopback, origin), 403) << origin;
  const SiteRules behind_a_proxy({}, PublicUrl("https://mesh.example/prefix/"), {}, true);
  EXPECT_EQ(status(behind_a_proxy, "https://mesh.example"), 200);
  EXPECT_EQ(status(behind_a_proxy, "https://mesh.example:443"), 200);
  EXPECT_EQ(status(behind_a_proxy, "http://mesh.example"), 403);
  EXPECT_EQ(status_of(kLoopback, head_of("localhost:8080")), 200) << "tools send no origin";
}

TEST(site_rules, an_allowed_origin_goes_before_what_the_browser_says) {
  const SiteRules rules({}, {}, Cors("https://tool.example"), true);
  const Fields fields{{"origin", "https://tool.example"}, {"sec-fetch-site", "cross-site"}};
  EXPECT_EQ(status_of(rules, head_of("localhost", fields)), 200);
  EXPECT_EQ(status_of(rules, head_of("evil.example", fields)), 421);
  EXPECT_EQ(status_of(rules, head_of("localhost", {{"origin", "https://tool.example"}, {"origin", "null"}})), 403);
}

TEST(site_rules, files_of_the_page_may_be_shown_and_linked_to_from_anywhere) {
  const auto status = [](const std::string& mode, const std::string& method, Access access) {
    return status_of(
        kLoopback, head_of("localhost", {{"sec-fetch-site", "cross-site"}, {"sec-fetch-mode", mode}}, method), access);
  };
  EXPECT_EQ(status("navigate", "GET", Access::kPageFile), 200);
  EXPECT_EQ(status("no-cors", "GET", Access::kPageFile), 200);
  EXPECT_EQ(status("no-cors", "HEAD", Access::kPageFile), 200);
  EXPECT_EQ(status("cors", "GET", Access::kPageFile), 403);
  EXPECT_EQ(status("navigate", "POST", Access::kPageFile), 403);
  EXPECT_EQ(status("navigate", "GET", Access::kGuarded), 403);
}

TEST(public_url, it_has_an_origin_and_a_prefix) {
  EXPECT_EQ(PublicUrl("https://mesh.example").prefix(), "");
  EXPECT_EQ(PublicUrl("https://mesh.example/").prefix(), "");
  EXPECT_EQ(PublicUrl("https://mesh.example:8443/a/b/").prefix(), "/a/b");
  EXPECT_EQ(PublicUrl("https://mesh.example:8443/a/b/").text(), "https://mesh.example:8443/a/b");
  for (const char* bad : {"", "mesh.example", "ftp://a", "http://", "https://a/b?c", "https://a/b c", "https://a//b",
                          "https://a/../b", "https://a/\"b"})
    EXPECT_THROW(PublicUrl{bad}, std::invalid_argument) << bad;
}

using sites = StubDaemon;

std::string from_page(const std::string& origin, const std::string& site = "") {
  return "Origin: " + origin + "\r\n" + (site.empty() ? "" : "Sec-Fetch-Site: " + site + "\r\n");
}

Answer get_as(int port, const std::string& path, const std::string& host) {
  return ask(port, "GET " + path + " HTTP/1.1\r\nHost: " + host + "\r\n\r\n");
}

TEST_F(sites, a_page_of_another_site_starts_nothing_and_reads_nothing) {
  config_.ops_bind = Address{"127.0.0.1", 0};
  start();
  const Answer refused = post(port_, "/v1/remesh", "good", from_page("https://evil.example", "cross-site"));
  EXPECT_EQ(refused.status, 403);
  EXPECT_EQ(code_of(refused), "cross_site");
  EXPECT_NE(refused.body.find("--cors-origin https://evil.example"), std::string::npos) << refused.body;
  EXPECT_EQ(post(port_, "/v1/remesh", "good", from_page("https://evil.example")).status, 403);
  EXPECT_EQ(post(port_, "/v1/jobs", "good", from_page("null")).status, 403);
  EXPECT_EQ(stub_.calls, 0);
  for (const int port : {port_, daemon_->ops_port()}) {
    const Answer rebound = get_as(port, "/metrics", "evil.example:8080");
    EXPECT_EQ(rebound.status, 421);
    EXPECT_EQ(code_of(rebound), "misdirected_request");
    EXPECT_NE(rebound.body.find("--allowed-hosts evil.example"), std::string::npos) << rebound.body;
    EXPECT_EQ(get_as(port, "/livez", "evil.example").status, 200);
    EXPECT_EQ(get_as(port, "/readyz", "evil.example").status, 200);
    EXPECT_EQ(get_as(port, "/nowhere", "evil.example").status, 421);
  }
  EXPECT_EQ(get_as(port_, "/", "evil.example").status, 421);
  EXPECT_EQ(post(port_, "/v1/remesh", "good", from_page("http://localhost", "same-origin")).status, 200);
}

TEST_F(sites, a_preflight_of_another_site_is_refused) {
  start();
  const std::string preflight =
      "OPTIONS /v1/remesh HTTP/1.1\r\nHost: localhost\r\nAccess-Control-Request-Method: POST\r\n";
  const Answer answer = ask(port_, preflight + from_page("https://evil.example") + "\r\n");
  EXPECT_EQ(answer.status, 403);
  EXPECT_EQ(answer.header("Access-Control-Allow-Origin"), "");
}

TEST_F(sites, with_a_key_the_name_and_the_site_do_not_matter) {
  config_.api_key = "0123456789abcdef-key";
  start();
  const std::string key = "X-API-Key: 0123456789abcdef-key\r\n";
  EXPECT_EQ(get_as(port_, "/", "mesh.example").status, 200);
  EXPECT_EQ(post(port_, "/v1/remesh", "good", key + from_page("https://tool.example", "cross-site")).status, 200);
  EXPECT_EQ(post(port_, "/v1/remesh", "good", from_page("https://tool.example", "cross-site")).status, 401);
}

}  // namespace
}  // namespace remesh::server
