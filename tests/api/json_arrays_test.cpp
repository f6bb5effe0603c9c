/// Compares the fast way to read a JSON mesh with the way by the events of a parser.
#include "api/json_arrays.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>

#include "api/json_reader.h"
#include "tests/support/random.h"
#include "tests/support/same_reading.h"

namespace remesh::api {
namespace {

/// The result of reading, or the error that it ended with.
struct Outcome {
  std::optional<ReadResult> result;
  std::optional<Error> error;
};

template <class Read>
Outcome outcome_of(const Read& read, std::string_view text, const ReadLimits& limits) {
  RunControl control;
  OptionReader options;
  try {
    return {read(text, limits, control, options), std::nullopt};
  } catch (const Error& error) {
    return {std::nullopt, error};
  }
}

/// Returns whether the text could be read.
bool expect_same_reading(std::string_view text, const ReadLimits& limits = {}) {
  const Outcome fast = outcome_of(read_json, text, limits);
  const Outcome slow = outcome_of(read_json_by_events, text, limits);
  EXPECT_EQ(fast.result.has_value(), slow.result.has_value()) << text;
  if (fast.result && slow.result) {
    EXPECT_TRUE(test::is_same_reading(*fast.result, *slow.result)) << text;
  } else if (fast.error && slow.error) {
    const auto facts = [](const Error& e) {
      return std::tuple(e.code, std::string(e.what()), e.line, e.element, e.limit);
    };
    EXPECT_EQ(facts(*fast.error), facts(*slow.error)) << text;
  }
  return fast.result.has_value();
}

PolygonMesh plain_vertices(std::string_view text) {
  RunControl control;
  PolygonMesh mesh;
  EXPECT_EQ(text[read_plain_vertices(text, 0, {}, control, &mesh)], ']') << text;
  return mesh;
}

TEST(json_arrays, numbers_are_read_as_the_parser_hands_them_on) {
  const PolygonMesh mesh = plain_vertices("[-0, -0.0,0.1]\n,\t[1E+2,\r-1.5e-3,12345678901234567890123]  ]");
  ASSERT_EQ(mesh.vertex_count(), 2u);
  EXPECT_EQ(mesh.positions[VertexId(1)], (Vec3{100, -0.0015, 12345678901234567890123.0}));
  EXPECT_FALSE(std::signbit(mesh.positions[VertexId(0)].x));
  EXPECT_TRUE(std::signbit(mesh.positions[VertexId(0)].y));
  EXPECT_EQ(plain_vertices("]").vertex_count(), 0u);
}

TEST(json_arrays, what_is_not_plain_is_left_to_the_parser) {
  RunControl control;
  PolygonMesh mesh;
  for (const char* text :
       {"",           "[",          "[1,2,3]",      "[1,2,3],",  "[1,2,3],]",   "[1,2]]",      "[1,2,3,4]]",
        "[1 2 3]]",   "[01,2,3]]",  "[+1,2,3]]",    "[.5,2,3]]", "[5.,2,3]]",   "[1.e3,2,3]]", "[1e,2,3]]",
        "[0x1,2,3]]", "[nan,2,3]]", "[1e999,2,3]]", "[-,2,3]]",  "[null,2,3]]", "{}]",         "[\"1\",2,3]]",
        "[[1],2,3]]", "[1,2,3]}"})
    EXPECT_THROW(read_plain_vertices(text, 0, {}, control, &mesh), NotPlain) << text;
  for (const char* text : {"", "[0,1,2]", "[0,1]]", "[0,1,2],]", "[0,1,-2]]", "[0,1,2.0]]", "[0,1,02]]", "[0,1,2e0]]",
                           "[0,1,123456789]]", "[]]", "[0,1,]]", "[0,1,[2]]]"})
    EXPECT_THROW(read_plain_faces(text, 0, {}, control, &mesh), NotPlain) << text;
}

TEST(json_arrays, limits_and_a_stop_are_obeyed) {
  RunControl control;
  PolygonMesh mesh;
  EXPECT_THROW(read_plain_vertices("[0,0,0],[0,0,1]]", 0, {.max_vertices = 1}, control, &mesh), NotPlain);
  EXPECT_THROW(read_plain_faces("[0,1,2],[0,1,2]]", 0, {.max_faces = 1}, control, &mesh), NotPlain);
  control.cancel();
  EXPECT_THROW(read_plain_faces("[0,1,2]]", 0, {}, control, &mesh), Error);
}

/// Returns a mesh as JSON that now and then has something odd or wrong in it.
std::string random_document(Random& random) {
  const auto blank = [&] { return random.chance(0.1) ? std::array{" ", "\n", "\r\n\t", "  "}[random.below(4)] : ""; };
  const double wildness = random.chance(0.5) ? 0.02 : 0;
  const auto wild = [&](std::string usual) {
    constexpr std::array kOdd{
        "-0",    "1e400", "-1e-400", "null", "NaN", "[]",       "01",         "1.",
        "\"1\"", "",      "1e2",     "{}",   "-1",  "99999999", "4294967295", "18446744073709551616",
        ",",     "]",     "true",    "1 1"};
    return random.chance(wildness) ? std::string(kOdd[random.below(static_cast<int>(kOdd.size()))]) : usual;
  };
  const auto list = [&](int items, const auto& item) {
    std::string text = "[";
    for (int i = 0; i < items; ++i) text += (i > 0 ? "," : "") + std::string(blank()) + item() + blank();
    return text + "]";
  };
  const int vertices = random.integer(3, 8), faces = random.integer(1, 5);
  const auto number = [&] {
    return wild(std::to_string(random.integer(-99, 99)) +
                (random.chance(0.5) ? "." + std::to_string(random.bits()) : ""));
  };
  const auto index = [&] { return wild(std::to_string(random.below(vertices))); };
  const std::string vertex_key = "\"vertices\":" + list(vertices, [&] { return wild(list(3, number)); });
  const std::string face_key = "\"faces\":" + list(faces, [&] { return wild(list(random.integer(3, 4), index)); });
  std::string keys = random.chance(0.5) ? vertex_key + "," + face_key : face_key + "," + vertex_key;
  if (random.chance(0.2)) keys += ",\"face_groups\":" + list(faces, [&] { return wild("7"); });
  if (random.chance(0.2)) keys = "\"other\":" + list(2, [&] { return list(3, number); }) + "," + keys;
  std::string text = "{" + keys + "}";
  if (random.chance(0.3)) text = "{\"options\":{\"refine\":" + wild("false") + "},\"mesh\":" + text + "}";
  if (random.chance(wildness)) text.resize(random.bits() % text.size());
  return text;
}

TEST(json_arrays, made_up_documents_are_read_alike) {
  Random random(3);
  int read = 0;
  constexpr int kDocuments = 5000;
  for (int i = 0; i < kDocuments; ++i) read += expect_same_reading(random_document(random));
  EXPECT_GT(read, kDocuments / 2);
  EXPECT_LT(read, kDocuments * 9 / 10);
}

TEST(json_arrays, limits_are_those_of_the_parser) {
  const std::string text = R"({"vertices":[[0,0,0],[1,0,0],[0,1,0]],"faces":[[0,1,2],[2,1,0]]})";
  EXPECT_TRUE(expect_same_reading(text, {.max_vertices = 3, .max_faces = 2}));
  EXPECT_FALSE(expect_same_reading(text, {.max_vertices = 2, .max_faces = 2}));
  EXPECT_FALSE(expect_same_reading(text, {.max_vertices = 3, .max_faces = 1}));
}

}  // namespace
}  // namespace remesh::api
