#include "server/http/chunked_decoder.h"

#include <gtest/gtest.h>

#include "server/http/http_message.h"

namespace remesh::server {
namespace {

struct Decoded {
  int status = 0;  ///< the status of the error, or 0
  bool is_done = false;
  std::size_t used = 0;
  std::string body;
};

Decoded decode(std::string_view text, std::size_t step, std::uint64_t max_body = 1000) {
  Decoded result;
  ChunkedDecoder decoder(max_body);
  try {
    for (std::size_t at = 0; at < text.size(); at += step) {
      result.used += decoder.decode(text.substr(at, step), result.body);
    }
  } catch (const HttpError& error) {
    result.status = error.problem.status;
  }
  result.is_done = decoder.is_done();
  return result;
}

TEST(chunked_decoder, chunks_are_joined_however_the_bytes_are_cut) {
  const std::string text = "5\r\nhello\r\n00A;name=\"v\"\r\n, chunked!\r\n0\r\nTrailer: x\r\n\r\n";
  for (std::size_t step = 1; step <= text.size(); ++step) {
    const Decoded result = decode(text + "next", step);
    EXPECT_EQ(result.status, 0);
    EXPECT_TRUE(result.is_done);
    EXPECT_EQ(result.body, "hello, chunked!");
    EXPECT_EQ(result.used, text.size());
  }
}

TEST(chunked_decoder, malformed_chunks_are_refused) {
  for (const std::string text : {"-2\r\n", "0x5\r\nhello\r\n", "+5\r\n", " 5\r\n", "5 \r\n", "\r\n", "g\r\n",
                                 "5\nhello", "00000000000000005\r\nhello\r\n", "5\r\nhello!\r\n", "5\r\nhello\n",
                                 "5\r\nhelloX\n", "5;a\nb\r\nhello", "5\rhello", "0\r\nTrailer: x\n\r\n", "0\r\n\rx"}) {
    for (const std::size_t step : {std::size_t{1}, text.size()}) {
      EXPECT_EQ(decode(text, step).status, 400) << text;
    }
  }
}

TEST(chunked_decoder, endless_extensions_and_trailers_are_refused) {
  EXPECT_EQ(decode("5;" + std::string(10'000, 'a'), 100).status, 400);
  EXPECT_EQ(decode("0\r\n" + std::string(10'000, 'a'), 100).status, 400);
}

TEST(chunked_decoder, the_cap_is_noticed_when_a_chunk_is_announced) {
  EXPECT_EQ(decode("3e8\r\n", 1).status, 0);
  EXPECT_EQ(decode("3e9\r\n", 1).status, 413);
  EXPECT_EQ(decode("3e8\r\n" + std::string(1000, 'a') + "\r\n1\r\n", 7).status, 413);
  EXPECT_EQ(decode("ffffffffffffffff\r\n", 1).status, 413);
  EXPECT_EQ(decode("1\r\na\r\nffffffffffffffff\r\n", 1).status, 413);
}

}  // namespace
}  // namespace remesh::server
