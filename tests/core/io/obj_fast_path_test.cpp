/// Compares the fast way to read OBJ with the way through tinyobjloader.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <array>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/io/gzip.h"
#include "core/io/obj/obj_readers.h"
#include "tests/support/invariance.h"
#include "tests/support/random.h"
#include "tests/support/reading.h"
#include "tests/support/same_reading.h"
#include "tests/support/shared_meshes.h"

namespace remesh {
namespace {

constexpr const char* kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

std::optional<ReadResult> read_plain(std::string_view text, int threads = 1, const ReadLimits& limits = {}) {
  RunControl control;
  return tbb::task_arena(threads).execute([&] { return read_obj_fast_path(text, limits, control); });
}

/// Returns what the reader of any OBJ gives, or nothing if it ends with an error.
std::optional<ReadResult> read_any(std::string_view text, const ReadLimits& limits = {}) {
  RunControl control;
  try {
    return read_obj_full_grammar(text, limits, control);
  } catch (const Error&) {
    return std::nullopt;
  }
}

/// Expects the same result from both readers if the text is plain. Returns whether it is plain.
bool expect_same_reading(std::string_view text, int threads = 1, const ReadLimits& limits = {}) {
  const std::optional<ReadResult> plain = read_plain(text, threads, limits);
  if (!plain) return false;
  const std::optional<ReadResult> any = read_any(text, limits);
  EXPECT_TRUE(any && test::is_same_reading(*plain, *any)) << text.substr(0, 2000);
  return true;
}

std::string repeated(std::string_view text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

TEST(obj_fast_path, every_plain_record_is_read_fast) {
  const std::string vertices = repeated("v 0.1 -2e-3 +3\n", 8);
  for (const char* lines : {"f 1 2 3",
                            "f 1/1 2/2/ 3//3 4/4/4",
                            "f -1 -2//7 -3/1/1",
                            "  f\t1  2\v3\f",
                            "f 1 2 3 # of three",
                            "# f 1 2 \x01",
                            "#\\",
                            "",
                            " \t ",
                            "o hull",
                            "g",
                            "g a b",
                            "g\ta \t b",
                            "usemtl  a  b # c ",
                            "mtllib a.mtl b.mtl",
                            "mtllib",
                            "vt 0 0",
                            "vn 0 0 1",
                            "s off",
                            "l 1 2",
                            "cstype bezier",
                            "v 1 2",
                            "v 1 2 3 4 red",
                            "v 1 2 3 # 4",
                            "v 1e-999 -1e-999 0",
                            "g C:\\a",
                            "o t\xfcr",
                            "f 00000001 2 3"}) {
    for (const char* line_end : {"\n", "\r\n", "\r"}) {
      const std::string text = vertices + lines + "\nf 1 2 3\n" + lines;
      EXPECT_TRUE(expect_same_reading(test::with_line_end(line_end, text))) << lines;
      EXPECT_TRUE(expect_same_reading(test::with_line_end(line_end, text + "\n"))) << lines;
      EXPECT_TRUE(expect_same_reading("\xef\xbb\xbf" + test::with_line_end(line_end, text))) << lines;
    }
  }
}

TEST(obj_fast_path, what_is_odd_or_wrong_is_left_to_the_other_reader) {
  const std::string good = repeated(kTriangle, 3) + "f 1 2 3\n";
  for (const std::string lines : {"f 1 2 \\\n3",
                                  "v 1 2 3 \\\n",
                                  "g a\\\nb",
                                  "vn 0 0 \\\n1",
                                  "f 1 2 3 # \\\n",
                                  "f 1 2 \\ \n3",
                                  "vn 0 0 \\ \n1",
                                  "vn 0 0 1\\ \n",
                                  "l 1 2 # \\\t\n",
                                  "g C:\\a\\ ",
                                  "fo 1 2 3",
                                  "v 1",
                                  "v",
                                  "v 1 x 3",
                                  "v 1 2 3x",
                                  "v 1 nan 2",
                                  "v inf 0 0",
                                  "v 1 2 1e999",
                                  "v 1 +-2 3",
                                  "v 1,0 2 3",
                                  "f",
                                  "f 1 2",
                                  "f 1 2 # 3",
                                  "f 0 1 2",
                                  "f 1 2 100",
                                  "f 1 2 -100",
                                  "f 1 2 999999999",
                                  "f 1 2 99999999999",
                                  "f 1 2 3/1/1/1",
                                  "f 1 2 3/x",
                                  "f 1 2 +3",
                                  "f 1 2 -",
                                  "f 1 2 3\\",
                                  "<html>",
                                  "1 2 3",
                                  "-f",
                                  "v# 1 2",
                                  "g a\x01",
                                  "v 1 2 3 # \x01",
                                  "f 1 2 3 # \x7f",
                                  "vn \x02"}) {
    EXPECT_FALSE(read_plain(good + lines)) << lines;
    EXPECT_FALSE(read_plain(good + lines + "\n" + good)) << lines;
  }
  EXPECT_FALSE(read_plain(std::string("\xff\xfe") + good));
  EXPECT_FALSE(read_plain(""));
  EXPECT_FALSE(read_plain(kTriangle));
  EXPECT_FALSE(read_plain(good + "g " + std::string(4097, 'n')));
  std::string keywords = good;
  for (int i = 0; i < 64; ++i) keywords += "k" + std::to_string(i) + " 1\n";
  EXPECT_FALSE(read_plain(keywords));
}

TEST(obj_fast_path, limits_are_those_of_the_other_reader) {
  const std::string text = repeated(kTriangle, 2) + "f 1 2 3\nf 3 2 1\n";
  EXPECT_TRUE(expect_same_reading(text, 1, {.max_vertices = 6, .max_faces = 2}));
  EXPECT_FALSE(read_plain(text, 1, {.max_vertices = 5, .max_faces = 2}));
  EXPECT_FALSE(read_plain(text, 1, {.max_vertices = 6, .max_faces = 1}));
}

/// Returns a line of any kind. Most lines are plain, and some are odd or wrong.
std::string random_line(Random& random, bool is_wild) {
  const auto pick = [&](auto n) { return random.below(static_cast<int>(n)); };
  const auto blank = [&] { return std::array{" ", "  ", "\t", " \v", " "}[pick(is_wild ? 5 : 2)]; };
  const auto number = [&] {
    constexpr std::array kOdd{"1e-330", "-0", "+1", ".5", "5.", "1E+2", "0x1", "nan", "1.#INF", "1e400", "1_0", ""};
    if (is_wild && pick(40) == 0) return std::string(kOdd[pick(kOdd.size())]);
    return std::to_string(pick(2000) - 1000) + (pick(2) == 0 ? "." + std::to_string(pick(100000)) : "");
  };
  const auto corner = [&] {
    std::string index = std::to_string(pick(4) == 0 ? -1 - pick(3) : 1 + pick(3));
    if (is_wild && pick(60) == 0)
      index = std::array{"0", "9999999", "-99999999", "123456789", "x", "1.5", "+1"}[pick(7)];
    if (pick(3) == 0) index += std::array{"/1", "//1", "/2/1", "/", "//", "/-1/-2", "/1/1/1"}[pick(is_wild ? 7 : 6)];
    return index;
  };
  std::string line;
  switch (pick(12)) {
    case 0:
    case 1:
    case 2:
    case 3: {
      line = "v";
      const int values = pick(15) == 0 ? 1 + pick(6) : 3;
      for (int i = 0; i < (is_wild ? values : 3); ++i) line += blank() + number();
      break;
    }
    case 4:
    case 5:
    case 6:
    case 7: {
      line = "f";
      const int corners = is_wild && pick(50) == 0 ? pick(3) : 3 + pick(3);
      for (int i = 0; i < corners; ++i) line += blank() + corner();
      break;
    }
    case 8: line = std::array{"g a", "g a  b", "g", "g\tc \t d", "g b a"}[pick(5)]; break;
    case 9: line = std::array{"o p", "o  q r", "usemtl m", "usemtl n # o", "mtllib a.mtl"}[pick(5)]; break;
    case 10: line = std::array{"vt 0 0", "vn 0 0 1", "s 1", "l 1 2", "# note", "#\\", "", " "}[pick(8)]; break;
    case 11: line = std::array{"vn 1 0 0", "vp 1", "call x", "#"}[pick(4)]; break;
  }
  if (is_wild && pick(25) == 0) line.insert(static_cast<std::size_t>(pick(line.size() + 1)), blank());
  if (is_wild && pick(30) == 0) line += std::array{" # tail", " \\", "\\", " #\\", "#", " \\ ", "\x1a"}[pick(7)];
  if (is_wild && pick(200) == 0) line += static_cast<char>(pick(256));
  return line + std::array{"\n", "\r\n", "\r"}[is_wild ? pick(3) : 0];
}

TEST(obj_fast_path, made_up_texts_are_read_alike) {
  Random random(1);
  int plain = 0;
  constexpr int kTexts = 4000;
  for (int i = 0; i < kTexts; ++i) {
    std::string text = kTriangle;
    const int lines = random.integer(1, 30);
    for (int k = 0; k < lines; ++k) text += random_line(random, true);
    if (random.chance(0.25)) text.pop_back();
    plain += expect_same_reading(text);
  }
  EXPECT_GT(plain, kTexts / 10);
  EXPECT_LT(plain, kTexts * 9 / 10);
}

/// Several chunks long: labels, relative indices and samples of vertices go across their borders.
TEST(obj_fast_path, long_texts_are_read_alike_by_any_number_of_threads) {
  Random random(2);
  std::string text = kTriangle;
  while (text.size() < 2'000'000) text += random_line(random, false);
  for (const int threads : {1, 2, 5}) EXPECT_TRUE(expect_same_reading(text, threads));
  const std::string spread = std::string("f 60001 60002 60003\n") + repeated("v 1 2 3\nv 1 2\nv 1 2 3 4\n", 40'000) +
                             "g late\nf -120000 -1 -60000\n" + std::string(600'000, ' ') + "\nf 120000 1 2\n";
  for (const int threads : {1, 3}) EXPECT_TRUE(expect_same_reading(spread, threads));
  EXPECT_FALSE(read_plain(spread + "f 1 2 120001\n", 2));
  EXPECT_FALSE(read_plain(spread + "f 1 2 -120001\n", 2));
}

STAGE(obj_fast_path, test::kStop) { (void)read_obj_fast_path(repeated(kTriangle, 50'000), {}, trial.control); }

TEST(obj_fast_path, real_meshes_are_read_alike) {
  namespace fs = std::filesystem;
  const fs::path folder = test::shared_meshes_folder();
  if (!test::has_shared_mesh()) return;
  int plain = 0, files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().string();
    if (!entry.is_regular_file() || (!name.ends_with(".obj") && !name.ends_with(".obj.gz"))) continue;
    std::ifstream file(entry.path(), std::ios::binary);
    std::string content{std::istreambuf_iterator<char>(file), {}};
    RunControl control;
    if (is_gzip(content)) content = gunzip(content, {}, control);
    ++files;
    plain += expect_same_reading(content, 2);
  }
  EXPECT_GT(files, 0);
  EXPECT_GT(plain, files / 2);
}

}  // namespace
}  // namespace remesh
