#include "core/io/common/text_lines.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/base/error.h"

namespace remesh {
namespace {

std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> lines;
  for (TextLines walk(text); walk.next();) {
    lines.emplace_back(walk.line());
    EXPECT_EQ(walk.number(), lines.size());
  }
  return lines;
}

TEST(text_lines, all_three_line_ends_part_lines_mixed_too) {
  using Lines = std::vector<std::string>;
  EXPECT_EQ(lines_of(""), Lines{});
  EXPECT_EQ(lines_of("a"), Lines{"a"});
  EXPECT_EQ(lines_of("a\nb\r\nc\rd\n"), (Lines{"a", "b", "c", "d"}));
  EXPECT_EQ(lines_of("\r\r\n\n"), (Lines{"", "", ""}));
  EXPECT_EQ(lines_of("\xef\xbb\xbf"
                     "a"),
            Lines{"a"});
}

TEST(text_lines, the_first_control_character_of_a_line_is_known) {
  TextLines walk(
      "a\tb\nc\x01"
      "d\x02\ne\n");
  ASSERT_TRUE(walk.next());
  EXPECT_NO_THROW(walk.check_is_text());
  ASSERT_TRUE(walk.next());
  EXPECT_EQ(walk.control_character(), 1);
  EXPECT_EQ(walk.line(),
            "c\x01"
            "d\x02");
  EXPECT_THROW(walk.check_is_text(), Error);
  ASSERT_TRUE(walk.next());
  EXPECT_FALSE(walk.control_character());
}

TEST(text_lines, other_encodings_are_refused_by_name) {
  const std::pair<std::string, std::string> marks[] = {{"\xff\xfe", "UTF-16 (little endian)"},
                                                       {"\xfe\xff", "UTF-16 (big endian)"},
                                                       {std::string("\xff\xfe\0\0", 4), "UTF-32 (little endian)"},
                                                       {std::string("\0\0\xfe\xff", 4), "UTF-32 (big endian)"}};
  for (const auto& [mark, name] : marks) {
    try {
      const TextLines walk(mark);
      ADD_FAILURE() << name;
    } catch (const Error& error) {
      EXPECT_EQ(error.code, Code::kInvalidMesh);
      EXPECT_EQ(error.line, 1u);
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace remesh
