#include "core/io/common/number_parsing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

namespace remesh {
namespace {

TEST(text, tokens_are_parted_by_any_number_of_blanks) {
  std::string_view rest = "  f\t1/2 \v\f 3 ";
  EXPECT_EQ(next_token(rest), "f");
  EXPECT_EQ(next_token(rest), "1/2");
  EXPECT_EQ(next_token(rest), "3");
  EXPECT_EQ(next_token(rest), "");
  EXPECT_EQ(next_token(rest), "");
}

TEST(text, trimming_takes_blanks_at_both_ends_only) {
  EXPECT_EQ(trim(" \ta b\f "), "a b");
  EXPECT_EQ(trim(" \t "), "");
  EXPECT_EQ(trim(""), "");
}

TEST(text, numbers_are_taken_in_every_shape_found_in_meshes) {
  const std::vector<std::pair<const char*, double>> cases = {
      {"1", 1},
      {"+1", 1},
      {"-1", -1},
      {".5", 0.5},
      {"5.", 5},
      {"-.7e+02", -70},
      {".8e-001", 0.08},
      {"+2.e1", 20},
      {"3E2", 300},
      {"007", 7},
      {"1e0000000002", 100},
      {"-0", -0.0},
      {"0e999999", 0},
      {"4.9e-324", std::numeric_limits<double>::denorm_min()},
      {"1.7976931348623157e308", std::numeric_limits<double>::max()}};
  for (const auto& [text, value] : cases) {
    const Real real = parse_real(text);
    EXPECT_EQ(real.fault, RealFault::kNone) << text;
    EXPECT_EQ(real.value, value) << text;
    EXPECT_EQ(std::signbit(real.value), std::signbit(value)) << text;
  }
}

TEST(text, what_is_no_number_as_a_whole_is_refused) {
  for (const char* text : {"",    "+",   "-",   ".",   "e5", "1e",     "1e+",   "1.5x", "0x10", "1,5",
                           "--1", "+-1", "-+1", "++1", "1 ", "3.1+e2", "1.2.3", "one",  "1.#",  "1d5"}) {
    EXPECT_EQ(parse_real(text).fault, RealFault::kNotANumber) << text;
  }
}

TEST(text, what_is_not_finite_is_told_from_what_is_no_number) {
  for (const char* text :
       {"nan", "NaN", "-nan", "inf", "+inf", "-Infinity", "1e999", "-1e999", "1e99999999999999999999",
        "1.7976931348623159e308", "0.0001e400", "1.#INF", "-1.#IND", "1.#QNAN", "-1.#INF00"}) {
    EXPECT_EQ(parse_real(text).fault, RealFault::kNotFinite) << text;
  }
  EXPECT_EQ(parse_real(std::string(400, '9')).fault, RealFault::kNotFinite);
  EXPECT_EQ(parse_real(std::string(400, '9') + ".5").fault, RealFault::kNotFinite);
}

TEST(text, what_is_below_the_smallest_double_is_zero_with_its_sign) {
  for (const std::string& text :
       {std::string("1e-999"), std::string("2.4e-324"), std::string("1e-99999999999999999999"),
        std::string("123456e-400"), "0." + std::string(400, '0') + "1", "0." + std::string(400, '0') + "1e+20",
        "." + std::string(400, '0') + "1"}) {
    for (const char* sign : {"", "-", "+"}) {
      const Real real = parse_real(sign + text);
      EXPECT_EQ(real.fault, RealFault::kNone) << text;
      EXPECT_EQ(real.value, 0) << text;
      EXPECT_EQ(std::signbit(real.value), *sign == '-') << text;
    }
  }
  EXPECT_EQ(parse_real("0." + std::string(400, '0') + "1e+410").value, 1e9) << "a long zero run is no underflow";
}

TEST(text, written_numbers_read_back_to_the_same_double) {
  for (const double value : {0.0, -0.0, 0.1, 1.0 / 3, 1e22, 1e23, -2.2250738585072014e-308, 5e-324,
                             1.7976931348623157e308, 9007199254740993.0, 3.4028234663852886e38}) {
    std::string text;
    append_real(text, value);
    const double back = std::strtod(text.c_str(), nullptr);
    EXPECT_EQ(back, value) << text;
    EXPECT_EQ(std::signbit(back), std::signbit(value)) << text;
  }
}

TEST(text, written_numbers_are_as_short_as_can_be) {
  for (const auto& [value, expected] : std::vector<std::pair<double, const char*>>{
           {0.1, "0.1"}, {1, "1"}, {-2.5, "-2.5"}, {1e23, "1e+23"}, {0.30000000000000004, "0.30000000000000004"}}) {
    std::string text;
    append_real(text, value);
    EXPECT_EQ(text, expected);
  }
}

TEST(text, integers_are_appended_in_decimal) {
  std::string text = "n=";
  append_integer(text, 0);
  append_integer(text, 18446744073709551615u);
  EXPECT_EQ(text, "n=018446744073709551615");
}

}  // namespace
}  // namespace remesh
