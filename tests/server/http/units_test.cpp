#include "server/http/units.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace remesh::server {
namespace {

using std::chrono::milliseconds;

TEST(units, sizes_counts_and_times_are_read) {
  EXPECT_EQ(parse_bytes("4096"), 4096u);
  EXPECT_EQ(parse_bytes("32KiB"), 32768u);
  EXPECT_EQ(parse_bytes("256MiB"), 268435456u);
  EXPECT_EQ(parse_bytes("20MB"), 20000000u);
  EXPECT_EQ(parse_count("10M"), 10000000u);
  EXPECT_EQ(parse_count("7"), 7u);
  EXPECT_EQ(parse_duration("30s"), milliseconds(30000));
  EXPECT_EQ(parse_duration("30"), milliseconds(30000));
  EXPECT_EQ(parse_duration("250ms"), milliseconds(250));
  EXPECT_EQ(parse_duration("5min"), milliseconds(300000));
}

TEST(units, anything_else_is_refused) {
  for (const char* text :
       {"", "x", "-1", "+1", " 1", "1 ", "1.5GiB", "3x", "MiB", "99999999999999999999", "17592186044415GiB"}) {
    EXPECT_THROW(parse_bytes(text), std::invalid_argument) << text;
    EXPECT_THROW(parse_count(text), std::invalid_argument) << text;
    EXPECT_THROW(parse_duration(text), std::invalid_argument) << text;
  }
}

TEST(units, what_is_shown_reads_back_the_same) {
  for (const std::uint64_t value : {0ull, 1ull, 1000ull, 1024ull, 1536ull, 256ull << 20, 10'000'000ull, 1ull << 40}) {
    EXPECT_EQ(parse_bytes(format_bytes(value)), value);
    EXPECT_EQ(parse_count(format_count(value)), value);
    EXPECT_EQ(parse_duration(format_duration(milliseconds(value))), milliseconds(value));
  }
  EXPECT_EQ(format_bytes(256ull << 20), "256MiB");
  EXPECT_EQ(format_count(50'000'000), "50M");
  EXPECT_EQ(format_duration(milliseconds(300'000)), "300s");
}

TEST(units, addresses_are_read_and_loopback_is_known) {
  EXPECT_EQ(parse_address("127.0.0.1:8080").text(), "127.0.0.1:8080");
  EXPECT_EQ(parse_address("[::1]:80").host, "::1");
  EXPECT_EQ(parse_address("[::1]:80").text(), "[::1]:80");
  EXPECT_TRUE(parse_address("localhost:0").is_loopback());
  EXPECT_TRUE(parse_address("127.9.9.9:1").is_loopback());
  EXPECT_TRUE(parse_address("[::1]:1").is_loopback());
  EXPECT_FALSE(parse_address("0.0.0.0:1").is_loopback());
  EXPECT_FALSE(parse_address("[::]:1").is_loopback());
  EXPECT_FALSE(parse_address("127.example.org:1").is_loopback());
  for (const char* text : {"", "8080", ":8080", "a:", "a:x", "a:70000", "::1:80", "a:-1", "[]:1"}) {
    EXPECT_THROW(parse_address(text), std::invalid_argument) << text;
  }
}

}  // namespace
}  // namespace remesh::server
