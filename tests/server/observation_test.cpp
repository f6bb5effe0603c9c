/// Tests what the daemon tells about itself: metrics, traces, digests.
#include <gtest/gtest.h>
#include <zlib.h>

#include <string>

#include "server/http/content_coding.h"
#include "server/http/digest.h"
#include "server/observe/metrics.h"
#include "server/observe/trace_context.h"
#include "tests/server/stub_daemon.h"

namespace remesh::server {
namespace {

const std::string kTrace = "4bf92f3577b34da6a3ce929d0e0e4736";
const std::string kParent = "00f067aa0ba902b7";

TEST(trace_context, trace_and_parent_are_read) {
  for (const std::string& text :
       {"00-" + kTrace + "-" + kParent + "-01", "cc-" + kTrace + "-" + kParent + "-01-more"}) {
    const auto trace = parse_traceparent(text);
    ASSERT_TRUE(trace) << text;
    EXPECT_EQ(trace->trace_id, kTrace);
    EXPECT_EQ(trace->parent_id, kParent);
  }
}

TEST(trace_context, what_is_not_as_the_standard_has_it_is_ignored) {
  for (const std::string& text :
       {std::string(), "00-" + kTrace + "-" + kParent, "ff-" + kTrace + "-" + kParent + "-01",
        "00-" + kTrace + "-" + kParent + "-01-more", "00-" + std::string(32, '0') + "-" + kParent + "-01",
        "00-" + kTrace + "-" + std::string(16, '0') + "-01", "00-" + std::string(32, 'A') + "-" + kParent + "-01",
        "00-" + kTrace + "-" + kParent + "-0g", "00_" + kTrace + "-" + kParent + "-01"}) {
    EXPECT_FALSE(parse_traceparent(text)) << text;
  }
}

TEST(digest, the_field_is_that_of_the_standard) {
  // RFC 9530, appendix D: {"hello": "world"} with a line feed
  EXPECT_EQ(repr_digest("{\"hello\": \"world\"}\n"), "sha-256=:RK/0qy18MlBSVnWgjwz6lZEWjP/lF5HF9bvEF8FabDg=:");
}

std::string unzip(const std::string& bytes) {
  z_stream stream{};
  inflateInit2(&stream, 15 + 16);
  std::string out(1 << 20, 0);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const int end = inflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  inflateEnd(&stream);
  return end == Z_STREAM_END ? out : "broken";
}

TEST(content_coding, gzip_is_what_another_reader_reads) {
  RunControl control;
  for (const std::size_t size : {0u, 1u, 70'000u, 1'000'000u}) {
    std::string text;
    while (text.size() < size) text += "v " + std::to_string(text.size()) + " 0 0\n";
    text.resize(size);
    EXPECT_EQ(unzip(gzip(text, control)), text) << size;
  }
}

TEST(content_coding, gzip_is_for_those_who_take_it) {
  for (const char* yes : {"gzip", "deflate, gzip;q=0.5", "GZIP", "*", "br, x-gzip", "gzip ; q=1"})
    EXPECT_TRUE(accepts_gzip(yes)) << yes;
  for (const char* no : {"", "identity", "deflate", "gzip;q=0", "gzip; q=0.000", "*;q=0", "gzip;q=0, *"})
    EXPECT_FALSE(accepts_gzip(no)) << no;
}

double value_of(const std::string& metrics, const std::string& series) {
  const std::size_t at = metrics.find("\n" + series + " ");
  return at == std::string::npos ? -1 : std::stod(metrics.substr(at + series.size() + 2));
}

using observation = StubDaemon;

TEST_F(observation, metrics_count_what_was_asked_and_answered) {
  config_.limits.max_body = 100;
  start();
  for (int i = 0; i < 3; ++i) post(port_, "/v1/remesh", "good");
  post(port_, "/v1/remesh", std::string(200, 'x'));
  get(port_, "/v1/requests/0123456789abcdef");
  get(port_, "/nowhere/" + std::string(50, 'x'));
  ask(port_, "BREW / HTTP/1.1\r\nHost: localhost\r\n\r\n");
  const std::string requests = "remeshd_http_requests_total{code=\"";
  std::string text;
  // An exchange is counted once its answer is written: a moment after the client has it.
  ASSERT_TRUE(eventually([&] {
    text = get(port_, "/metrics").body;
    return value_of(text, requests + "501\",method=\"other\",route=\"none\"}") == 1;
  }));
  EXPECT_EQ(value_of(text, requests + "200\",method=\"POST\",route=\"/v1/remesh\"}"), 3) << text;
  EXPECT_EQ(value_of(text, requests + "413\",method=\"POST\",route=\"/v1/remesh\"}"), 1);
  EXPECT_EQ(value_of(text, requests + "404\",method=\"GET\",route=\"/v1/requests/{id}\"}"), 1);
  EXPECT_EQ(value_of(text, requests + "404\",method=\"GET\",route=\"none\"}"), 1);
  EXPECT_EQ(value_of(text, "remeshd_http_rejected_total{reason=\"body_too_large\"}"), 1);
  EXPECT_EQ(value_of(text, "remeshd_http_request_duration_seconds_count{route=\"/v1/remesh\"}"), 4);
  EXPECT_EQ(value_of(text, "remeshd_ready"), 1);
  EXPECT_GT(value_of(text, "process_resident_memory_bytes"), 1e6);
  EXPECT_GT(value_of(text, "process_open_fds"), 3);
}

TEST(metrics, keys_are_counted_by_name_up_to_a_thousand_names) {
  Metrics metrics;
  for (int i = 0; i < 3; ++i) metrics.count_key("anna", 200, 0.5);
  metrics.count_key("anna", 429, 0);
  for (int i = 0; i < 2000; ++i) metrics.count_key("name" + std::to_string(i), 200, 1);
  const std::string text = metrics.text({});
  EXPECT_EQ(value_of(text, "remeshd_key_requests_total{code=\"200\",key=\"anna\"}"), 3);
  EXPECT_EQ(value_of(text, "remeshd_key_requests_total{code=\"429\",key=\"anna\"}"), 1);
  EXPECT_EQ(value_of(text, "remeshd_key_work_seconds_total{key=\"anna\"}"), 1.5);
  EXPECT_EQ(value_of(text, "remeshd_key_requests_total{code=\"200\",key=\"other\"}"), 2000 - 999);
}

TEST_F(observation, a_client_that_leaves_is_counted_as_such) {
  start();
  start_blocking()->close();
  EXPECT_TRUE(eventually([&] {
    return value_of(get(port_, "/metrics").body,
                    "remeshd_http_requests_total{code=\"499\",method=\"POST\",route=\"/v1/remesh\"}") == 1;
  }));
}

TEST_F(observation, results_carry_the_digest_of_what_is_sent) {
  start();
  const Answer plain = post(port_, "/v1/remesh", "good");
  EXPECT_EQ(plain.header("Repr-Digest"), repr_digest(plain.body));
  EXPECT_EQ(plain.header("Content-Encoding"), "");
  EXPECT_EQ(plain.header("Vary"), "Accept-Encoding");
  const std::string large = "/v1/remesh?name=" + std::string(2000, 'x');
  const Answer zipped = post(port_, large, "good", "Accept-Encoding: gzip\r\n");
  EXPECT_EQ(zipped.header("Content-Encoding"), "gzip");
  EXPECT_EQ(zipped.header("Repr-Digest"), repr_digest(zipped.body));
  EXPECT_LT(zipped.body.size(), 1000u);
  EXPECT_EQ(unzip(zipped.body), post(port_, large, "good").body);
}

TEST_F(observation, documents_and_metrics_are_compressed_where_the_client_takes_that) {
  openapi_ = "{\"paths\":{" + std::string(2000, ' ') + "}}";
  start();
  EXPECT_EQ(get(port_, "/v1/capabilities").header("Vary"), "Accept-Encoding");
  for (const std::string path : {"/openapi.json", "/metrics"}) {
    const Answer plain = get(port_, path);
    EXPECT_EQ(plain.header("Content-Encoding"), "") << path;
    EXPECT_EQ(plain.header("Vary"), "Accept-Encoding") << path;
    const Answer zipped = ask(port_, "GET " + path + " HTTP/1.1\r\nHost: localhost\r\nAccept-Encoding: gzip\r\n\r\n");
    ASSERT_EQ(zipped.header("Content-Encoding"), "gzip") << path;
    EXPECT_LT(zipped.body.size(), plain.body.size()) << path;
    EXPECT_EQ(unzip(zipped.body).substr(0, 40), plain.body.substr(0, 40)) << path;
  }
}

}  // namespace
}  // namespace remesh::server
