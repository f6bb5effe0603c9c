#include "api/json_writer.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>
#include <string>
#include <vector>

namespace remesh::api {
namespace {

std::string number(double value) {
  JsonWriter json;
  json.number(value);
  return json.take();
}

std::string string(std::string_view value) {
  JsonWriter json;
  json.string(value);
  return json.take();
}

TEST(json_writer, commas_stand_between_and_nowhere_else) {
  JsonWriter json;
  json.begin_object();
  json.key("a");
  json.begin_array();
  json.end_array();
  json.key("b");
  json.begin_array();
  json.integer(1);
  json.signed_integer(-2);
  json.begin_object();
  json.end_object();
  json.null();
  json.boolean(true);
  json.end_array();
  json.key("c");
  json.string("x");
  json.end_object();
  EXPECT_EQ(json.take(), R"({"a":[],"b":[1,-2,{},null,true],"c":"x"})");
}

TEST(json_writer, numbers_are_short_and_read_back_to_the_same_bits) {
  EXPECT_EQ(number(0.1), "0.1");
  EXPECT_EQ(number(2), "2");
  EXPECT_EQ(number(-0.0), "-0.0");
  std::mt19937_64 random(7);
  for (int i = 0; i < 10000; ++i) {
    const double value = std::bit_cast<double>(random());
    if (!std::isfinite(value)) continue;
    const double back = nlohmann::json::parse(number(value)).get<double>();
    EXPECT_EQ(std::bit_cast<std::uint64_t>(back), std::bit_cast<std::uint64_t>(value));
  }
}

TEST(json_writer, pieces_are_the_text_in_their_order) {
  const auto write = [](JsonWriter& json) {
    std::vector<std::uint64_t> numbers(1000);
    std::iota(numbers.begin(), numbers.end(), 0U);
    json.object([&] { json.values("numbers", numbers); });
  };
  JsonWriter whole, in_pieces(64);
  write(whole);
  write(in_pieces);
  EXPECT_EQ(in_pieces.size(), whole.size());
  const std::vector<std::string> pieces = in_pieces.take_pieces();
  EXPECT_EQ(std::accumulate(pieces.begin(), pieces.end(), std::string()), whole.take());
  for (const std::string& piece : pieces) EXPECT_LT(piece.size(), 80u);
}

TEST(json_writer, what_is_not_finite_is_null) {
  EXPECT_EQ(number(std::numeric_limits<double>::infinity()), "null");
  EXPECT_EQ(number(std::nan("")), "null");
}

TEST(json_writer, the_smallest_integer_keeps_its_value) {
  JsonWriter json;
  json.signed_integer(std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(json.take(), "-9223372036854775808");
}

TEST(json_writer, strings_are_escaped_and_read_back) {
  for (const std::string_view text :
       {"", "plain", "\"quoted\" \\ back", "line\nline\r\t\x01\x7f", "gr\xc3\xbc\xc3\x9f", "\xf0\x9f\x98\x80"}) {
    EXPECT_EQ(nlohmann::json::parse(string(text)).get<std::string>(), text);
  }
}

TEST(json_writer, bytes_that_are_no_utf8_are_replaced) {
  EXPECT_EQ(string("a\xff"
                   "b"),
            "\"a\xEF\xBF\xBD"
            "b\"");
  // Cut off, overlong, a surrogate, too large.
  for (const std::string_view bad :
       {"\xc3", "\xe2\x82", "\xf0\x9f\x98", "\xc0\xaf", "\xe0\x80\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\x80"}) {
    EXPECT_TRUE(nlohmann::json::accept(string(bad))) << string(bad);
    EXPECT_TRUE(nlohmann::json::accept(string(std::string(bad) + "\"x")));
  }
}

}  // namespace
}  // namespace remesh::api
