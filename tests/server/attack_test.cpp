/// Tests the real binary against what hostile clients send. Each client gets the status of the contract at once, and
/// then the connection closes. The daemon's memory does not grow. "At once" means that it costs the daemon less than a
/// second of the processor's time, and that it waits for nothing: its own limits are longer than a client's patience.
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "tests/server/daemon_process.h"
#include "tests/server/raw_client.h"
#include "tests/support/sanitizer.h"
#include "tests/support/time_limit.h"

namespace remesh::server {
namespace {

constexpr std::uint64_t kMebibyte = 1 << 20;
/// The limit is larger with a sanitizer, because it stores shadow memory and does not release what was freed.
constexpr std::uint64_t kMaxGrowth = (kIsSanitized ? 1024 : 64) * kMebibyte;

struct Attack {
  std::string name;
  std::string bytes;
  int status;
  std::string code;
};

const std::string kPost = "POST /v1/remesh HTTP/1.1\r\nHost: localhost\r\n";
const std::string kChunked = kPost + "Transfer-Encoding: chunked\r\n\r\n";

std::string repeated(const std::string& text, std::size_t times) {
  std::string all;
  all.reserve(text.size() * times);
  for (std::size_t i = 0; i < times; ++i) all += text;
  return all;
}

std::string with_length(const std::string& fields, const std::string& body) {
  return kPost + fields + "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body;
}

std::vector<Attack> attacks() {
  const std::string bad = "malformed_request";
  std::vector<Attack> list{
      {"no length", kPost + "\r\n", 411, "length_required"},
      {"10 GB announced", kPost + "Content-Length: 10000000000\r\n\r\n", 413, "body_too_large"},
      {"10 GB in one chunk", kChunked + "2540BE400\r\n", 413, "body_too_large"},
      {"100,000 fields", kPost + repeated("A: b\r\n", 100'000) + "\r\n", 431, "header_fields_too_large"},
      {"101 fields", kPost + repeated("A: b\r\n", 100) + "\r\n", 431, "header_fields_too_large"},
      {"a field of 100 kB", kPost + "A: " + std::string(100'000, 'b') + "\r\n\r\n", 431, "header_fields_too_large"},
      {"a path of 100 kB", "GET /" + std::string(100'000, 'b') + " HTTP/1.1\r\nHost: localhost\r\n\r\n", 414,
       "uri_too_long"},
      {"length and chunks", kPost + "Content-Length: 5\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n", 400, bad},
      {"chunks and length", kPost + "Transfer-Encoding: chunked\r\nContent-Length: 5\r\n\r\n0\r\n\r\n", 400, bad},
      {"two lengths", kPost + "Content-Length: 5\r\nContent-Length: 6\r\n\r\nhello", 400, bad},
      {"one length twice", kPost + "Content-Length: 5\r\nContent-Length: 5\r\n\r\nhello", 400, bad},
      {"chunked twice", kPost + "Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n", 400, bad},
      {"chunks of gzip", kPost + "Transfer-Encoding: gzip, chunked\r\n\r\n0\r\n\r\n", 501, "not_implemented"},
      {"chunks in 1.0", "POST /v1/remesh HTTP/1.0\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n", 400, bad},
      {"no blank line end", "GET /livez HTTP/1.1\nHost: localhost\n\n", 400, bad},
      {"one bare line feed", "GET /livez HTTP/1.1\r\nHost: localhost\nA: b\r\n\r\n", 400, bad},
      {"a carriage return in a line", "GET /livez HTTP/1.1\r\nHost: localhost\rA: b\r\n\r\n", 400, bad},
      {"a folded field", "GET /livez HTTP/1.1\r\nHost: localhost\r\nA: b\r\n  c\r\n\r\n", 400, bad},
      {"a blank before the colon", "GET /livez HTTP/1.1\r\nHost : x\r\n\r\n", 400, bad},
      {"no name", "GET /livez HTTP/1.1\r\nHost: localhost\r\n: b\r\n\r\n", 400, bad},
      {"a NUL in a field", std::string("GET /livez HTTP/1.1\r\nHost: localhost\r\nA: \0\r\n\r\n", 46), 400, bad},
      {"a NUL in the path", "GET /livez%00 HTTP/1.1\r\nHost: localhost\r\n\r\n", 400, bad},
      {"half an escape", "GET /livez%0 HTTP/1.1\r\nHost: localhost\r\n\r\n", 400, bad},
      {"an escaped line end", "GET /livez%0d%0aA:%20b HTTP/1.1\r\nHost: localhost\r\n\r\n", 404, "not_found"},
      {"no host", "GET /livez HTTP/1.1\r\n\r\n", 400, bad},
      {"two hosts", "GET /livez HTTP/1.1\r\nHost: localhost\r\nHost: y\r\n\r\n", 400, bad},
      {"no version", "GET /livez\r\n\r\n", 400, bad},
      {"HTTP/2", "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", 505, "http_version_not_supported"},
      {"TLS", std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", 11), 400, bad},
      {"an empty line first", "\r\nGET /livez HTTP/1.1\r\nHost: localhost\r\n\r\n", 400, bad},
      {"an unknown method", "BREW /livez HTTP/1.1\r\nHost: localhost\r\n\r\n", 501, "not_implemented"},
      {"a body where none is taken", "GET /livez HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5\r\n\r\nhello", 413,
       "body_too_large"},
      {"another body coding", with_length("Content-Encoding: br\r\n", "hello"), 415, "unsupported_media_type"},
      {"JSON a million deep", with_length("Content-Type: application/json\r\n", "{\"x\":" + repeated("[", 1'000'000)),
       400, "malformed_json"},
      {"a mesh a million deep",
       with_length("Content-Type: application/json\r\n", "{\"vertices\":" + repeated("[", 1'000'000)), 422,
       "invalid_mesh"},
      {"objects a million deep", with_length("Content-Type: application/json\r\n", repeated("{\"mesh\":", 1'000'000)),
       400, "malformed_json"},
      {"10,000 parts",
       with_length("Content-Type: multipart/form-data; boundary=b\r\n",
                   repeated("--b\r\nContent-Disposition: form-data; name=\"mesh\"\r\n\r\nx\r\n", 10'000) + "--b--\r\n"),
       400, "malformed_multipart"},
      {"an endless boundary",
       with_length("Content-Type: multipart/form-data; boundary=" + std::string(5'000, 'b') + "\r\n", "x"), 400,
       "malformed_multipart"},
      {"100,000 options",
       "POST /v1/remesh?" + repeated("a&", 15'000) + " HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1\r\n\r\nx", 400,
       "unknown_option"},
  };
  for (const std::string length : {"+5", "-5", "0x5", "5,5", "5 5", "", "five", "99999999999999999999999"})
    list.push_back({"length " + length, kPost + "Content-Length: " + length + "\r\n\r\nhello", 400, bad});
  for (const std::string size : {"-2", "0x5", "00000000000000005", "", "g", " 5", "5 ", "+5"})
    list.push_back({"chunk size " + size, kChunked + size + "\r\nhello\r\n0\r\n\r\n", 400, bad});
  list.push_back({"a chunk longer than its size", kChunked + "4\r\nhello\r\n0\r\n\r\n", 400, bad});
  list.push_back({"a chunk with a bare line feed", kChunked + "5\nhello\r\n0\r\n\r\n", 400, bad});
  list.push_back({"an endless chunk extension", kChunked + "5;" + std::string(100'000, 'x'), 400, bad});
  list.push_back({"endless trailers", kChunked + "0\r\n" + repeated("A: b\r\n", 10'000), 400, bad});
  return list;
}

std::string code_in(const Answer& answer) {
  return nlohmann::json::parse(answer.body, nullptr, false).value("code", "");
}

class attack : public ::testing::Test {
 protected:
  attack() {
    // Memory that the daemon needs for any request at all does not count, so one is sent first.
    EXPECT_EQ(post(daemon_.port(), "/v1/remesh", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").status, 200);
    idle_ = daemon_.memory("VmRSS");
    daemon_.forget_peak();
  }
  void expect_unmoved(const std::string& after) {
    EXPECT_LT(daemon_.memory("VmHWM"), idle_ + kMaxGrowth) << after;
    EXPECT_EQ(get(daemon_.port(), "/livez").status, 200) << after;
    daemon_.forget_peak();
  }

  void expect_refused(const Attack& attack) {
    const test::Seconds before = daemon_.processor_time();
    RawClient client(daemon_.port());
    client.send(attack.bytes);
    const std::string received = client.receive();
    EXPECT_TRUE(client.is_ended()) << attack.name << ": the connection stays open";
    test::expect_within(test::Seconds(1), daemon_.processor_time() - before, attack.name);
    const Answer answer = Answer::parse(received);
    EXPECT_EQ(answer.status, attack.status) << attack.name << received.substr(0, 500);
    EXPECT_EQ(code_in(answer), attack.code) << attack.name;
    EXPECT_EQ(answer.header("Connection"), "close") << attack.name;
    EXPECT_EQ(answer.header("Content-Type"), "application/problem+json") << attack.name;
    EXPECT_EQ(received.find("\nHTTP/1.1 "), std::string::npos) << attack.name << ": a second answer";
    expect_unmoved(attack.name);
  }

  DaemonProcess daemon_{{"--head-timeout", "600s", "--write-timeout", "600s"}};
  std::uint64_t idle_ = 0;
};

TEST_F(attack, each_attack_gets_its_status_at_once_and_the_connection_closes) {
  for (const Attack& attack : attacks()) expect_refused(attack);
}

/// Sends `piece` again and again, up to `most` bytes, until there is an answer.
Answer flood(int port, const std::string& start, const std::string& piece, std::uint64_t most) {
  RawClient client(port);
  client.send(start);
  for (std::uint64_t sent = 0; sent < most && !client.has_input(); sent += piece.size()) {
    if (!client.send(piece)) break;
  }
  return client.answer();
}

TEST_F(attack, a_line_of_a_gigabyte_is_refused_when_it_passes_the_limit) {
  const std::string much(64 << 10, 'a');
  constexpr std::uint64_t kGigabyte = 1'000'000'000;
  EXPECT_EQ(flood(daemon_.port(), "GET /", much, kGigabyte).status, 414);
  expect_unmoved("the request line");
  EXPECT_EQ(flood(daemon_.port(), kPost + "A: ", much, kGigabyte).status, 431);
  expect_unmoved("a field");
  EXPECT_EQ(flood(daemon_.port(), kChunked, std::string(64 << 10, '0'), kGigabyte).status, 400);
  expect_unmoved("a chunk's size");
}

TEST_F(attack, chunks_without_end_are_refused_at_the_limit_of_the_body) {
  const std::string chunk = "10000\r\n" + std::string(0x10000, 'a') + "\r\n";
  const Answer answer = flood(daemon_.port(), kChunked, chunk, 1'000'000'000);
  EXPECT_EQ(answer.status, 413);
  EXPECT_EQ(code_in(answer), "body_too_large");
  expect_unmoved("chunks without end");
}

TEST_F(attack, many_bodies_that_never_end_take_no_memory) {
  const std::string chunk = "400000\r\n" + std::string(0x400000, 'a') + "\r\n";
  std::vector<std::unique_ptr<RawClient>> clients;
  for (int i = 0; i < 24; ++i) {
    clients.push_back(std::make_unique<RawClient>(daemon_.port()));
    clients.back()->send(kChunked + chunk);
  }
  expect_unmoved("24 bodies of 4 MiB that go on");
}

TEST_F(attack, what_follows_a_refused_request_is_not_taken_for_another) {
  const std::string smuggled = "GET /v1/capabilities HTTP/1.1\r\nHost: localhost\r\n\r\n";
  const std::string length = "Content-Length: " + std::to_string(smuggled.size()) + "\r\n\r\n";
  // The connection is closed even if the client asks to keep it open.
  const std::string keep = "Connection: keep-alive\r\n";
  for (const std::string& first :
       {kPost + keep + "Content-Length: 0\r\n" + length, "GET /livez HTTP/1.1\r\nHost: localhost\r\n" + keep + length,
        "GET /none HTTP/1.1\r\nHost: localhost\r\n" + keep + length,
        kPost + keep + "Transfer-Encoding: chunked\r\n\r\n0\r\n\r\n"}) {
    const std::string received = [&] {
      RawClient client(daemon_.port());
      client.send(first + smuggled);
      return client.receive();
    }();
    EXPECT_EQ(received.rfind("HTTP/1.1 ", 0), 0u);
    EXPECT_EQ(received.find("HTTP/1.1 ", 1), std::string::npos) << received;
  }
}

/// Returns `count` zero bytes under gzip, which makes them a thousand times smaller.
std::string zeros_in_gzip(std::uint64_t count) {
  z_stream stream{};
  deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, 15 + 16, 8, Z_RLE);
  std::string zeros(1 << 20, '\0');
  std::array<char, 1 << 16> buffer;
  std::string out;
  for (bool is_last = false; !is_last;) {
    const std::uint64_t part = std::min<std::uint64_t>(count, zeros.size());
    is_last = (count -= part) == 0;
    stream.next_in = reinterpret_cast<Bytef*>(zeros.data());
    stream.avail_in = static_cast<uInt>(part);
    do {
      stream.next_out = reinterpret_cast<Bytef*>(buffer.data());
      stream.avail_out = static_cast<uInt>(buffer.size());
      deflate(&stream, is_last ? Z_FINISH : Z_NO_FLUSH);
      out.append(buffer.data(), buffer.size() - stream.avail_out);
    } while (stream.avail_out == 0);
  }
  deflateEnd(&stream);
  return out;
}

TEST_F(attack, a_gzip_bomb_is_refused_whichever_way_it_comes) {
  const std::string bomb = zeros_in_gzip(std::uint64_t{1} << 30);
  ASSERT_LT(bomb.size(), 2 * kMebibyte);
  const std::string form =
      "--b\r\nContent-Disposition: form-data; name=\"mesh\"; filename=\"a.obj.gz\"\r\n\r\n" + bomb + "\r\n--b--\r\n";
  const std::string size = [&] {
    std::array<char, 20> text{};
    std::snprintf(text.data(), text.size(), "%zx", bomb.size());
    return std::string(text.data());
  }();
  const std::string code = "decompressed_too_large";
  for (const Attack& attack : std::vector<Attack>{
           {"a bomb as a coding", with_length("Content-Encoding: gzip\r\n", bomb), 413, code},
           {"a bomb as a mesh", with_length("", bomb), 413, code},
           {"a bomb in a form", with_length("Content-Type: multipart/form-data; boundary=b\r\n", form), 413, code},
           {"a bomb in JSON", with_length("Content-Type: application/json\r\nContent-Encoding: gzip\r\n", bomb), 413,
            code},
           {"a bomb in chunks", kChunked + size + "\r\n" + bomb + "\r\n0\r\n\r\n", 413, code},
       }) {
    expect_refused(attack);
  }
}

}  // namespace
}  // namespace remesh::server
