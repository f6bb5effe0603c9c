#include "server/http/body.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <string>
#include <utility>

#include "server/http/memory_files.h"

namespace remesh::server {
namespace {

std::string pattern(std::size_t size) {
  std::string text(size, ' ');
  for (std::size_t i = 0; i < size; ++i) text[i] = static_cast<char>('a' + i * i % 26);
  return text;
}

Body body_in_pieces(const std::string& text, std::size_t piece) {
  Body body;
  for (std::size_t at = 0; at < text.size(); at += piece) body.append(std::string_view(text).substr(at, piece));
  body.seal();
  return body;
}

TEST(body, what_is_put_in_comes_out_from_memory_or_from_the_file) {
  constexpr std::size_t kEdge = Body::kInMemory;
  for (const std::size_t size : {std::size_t{0}, std::size_t{5}, kEdge - 1, kEdge, kEdge + 1, 3 * kEdge + 77}) {
    const std::string text = pattern(size);
    const Body body = body_in_pieces(text, 65'000);
    EXPECT_EQ(body.size(), size);
    EXPECT_TRUE(body.view() == text) << size;
    EXPECT_EQ(body.is_in_file(), size > kEdge) << size;
  }
}

TEST(body, one_that_comes_in_a_single_piece_is_the_same) {
  const std::string text = pattern(2 * Body::kInMemory);
  EXPECT_TRUE(body_in_pieces(text, text.size()).view() == text);
}

TEST(body, it_can_be_handed_on_and_dropped) {
  const std::string text = pattern(2 * Body::kInMemory);
  Body first = body_in_pieces(text, 100'000);
  Body second = std::move(first);
  EXPECT_TRUE(second.view() == text);
  second = Body();
  EXPECT_EQ(second.size(), 0u);
  EXPECT_FALSE(second.is_in_file());
}

TEST(body, where_no_file_can_be_made_it_lies_in_memory) {
  ::setenv("TMPDIR", "/proc", 1);
  const std::string text = pattern(2 * Body::kInMemory);
  EXPECT_TRUE(body_in_pieces(text, 100'000).view() == text);
  ::unsetenv("TMPDIR");
}

TEST(body, what_lies_in_a_file_in_memory_is_counted_unless_it_is_mapped) {
  ::setenv("TMPDIR", "/proc", 1);
  const std::string text = pattern(2 * Body::kInMemory);
  const std::uint64_t before = memory_file_bytes();
  {
    Body body;
    body.append(text);
    EXPECT_EQ(memory_file_bytes(), before + text.size());
    body.seal();
    EXPECT_EQ(memory_file_bytes(), before) << "it is resident";
    Body moved = std::move(body);
    moved.rest();
    EXPECT_EQ(memory_file_bytes(), before + text.size());
  }
  EXPECT_EQ(memory_file_bytes(), before);
  ::unsetenv("TMPDIR");
}

}  // namespace
}  // namespace remesh::server
