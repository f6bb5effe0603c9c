#include "core/io/gzip.h"

#include <gtest/gtest.h>

#include <optional>
#include <random>
#include <string>

#include "core/base/error.h"

namespace remesh {
namespace {

std::string pack(std::string_view content) {
  RunControl control;
  return gzip(content, control);
}
std::string unpack(std::string_view content, const DecompressionLimits& limits = {}) {
  RunControl control;
  return gunzip(content, limits, control);
}
/// Returns the error of unpacking, or nothing if there is none.
std::optional<Error> gzip_error_of(std::string_view content, const DecompressionLimits& limits = {}) {
  try {
    (void)unpack(content, limits);
    return std::nullopt;
  } catch (const Error& error) {
    return error;
  }
}

std::string noise(std::size_t size) {
  std::mt19937 random(20240611);
  std::string bytes(size, '\0');
  for (char& byte : bytes) byte = static_cast<char>(random());
  return bytes;
}

TEST(gzip, what_is_packed_unpacks_to_itself) {
  for (const std::size_t size : {0u, 1u, 70'000u, 3'000'000u}) {
    const std::string content = noise(size);
    EXPECT_EQ(unpack(pack(content)), content) << size;
    EXPECT_TRUE(is_gzip(pack(content)));
  }
  EXPECT_FALSE(is_gzip("v 0 0 0"));
}

/// `printf abc | gzip -n`
constexpr std::string_view kByGzip("\x1f\x8b\x08\0\0\0\0\0\0\x03\x4b\x4c\x4a\x06\0\xc2\x41\x24\x35\x03\0\0\0", 23);

TEST(gzip, what_the_program_of_that_name_packs_is_unpacked_several_members_and_padding_too) {
  const std::string packed(kByGzip);
  EXPECT_EQ(unpack(packed), "abc");
  EXPECT_EQ(unpack(packed + packed + pack("def")), "abcabcdef");
  EXPECT_EQ(unpack(packed + std::string(100, '\0')), "abc");
}

TEST(gzip, damage_and_what_is_cut_off_or_follows_is_an_error_at_its_byte) {
  const std::string packed = pack(noise(100'000));
  for (const std::size_t size : {std::size_t{2}, std::size_t{10}, packed.size() / 2, packed.size() - 1}) {
    const auto error = gzip_error_of(packed.substr(0, size));
    ASSERT_TRUE(error) << size;
    EXPECT_EQ(error->code, Code::kInvalidMesh);
    EXPECT_EQ(error->byte, size);
  }
  EXPECT_EQ(gzip_error_of(packed + "more")->byte, packed.size());
  std::string damaged = packed;
  damaged[packed.size() - 6] ^= 1;  // in the checksum
  EXPECT_EQ(gzip_error_of(damaged)->code, Code::kInvalidMesh);
  EXPECT_EQ(gzip_error_of("plain text")->code, Code::kInvalidMesh);
}

TEST(gzip, the_size_is_bounded_to_the_byte) {
  const std::string content = noise(2'500'000);
  const std::string packed = pack(content);
  EXPECT_EQ(unpack(packed, {content.size(), 100}), content);
  const auto error = gzip_error_of(packed, {content.size() - 1, 100});
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code, Code::kDecompressedTooLarge);
  EXPECT_EQ(error->limit, content.size() - 1);
}

TEST(gzip, a_bomb_is_refused_by_its_ratio_and_a_small_file_is_free_of_it) {
  const std::string zeros = pack(std::string(50'000'000, '\0'));
  const auto error = gzip_error_of(zeros, {std::uint64_t{1} << 30, 100});
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code, Code::kDecompressedTooLarge);
  EXPECT_EQ(error->limit, 100u);
  EXPECT_EQ(unpack(zeros, {std::uint64_t{1} << 30, 2000}).size(), 50'000'000u);
  const std::string small(500'000, '\0');
  EXPECT_EQ(unpack(pack(small), {std::uint64_t{1} << 30, 2}), small);
}

}  // namespace
}  // namespace remesh
