// Tests POST /v1/compare as a function.

#include "api/comparison.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "api/operations.h"
#include "api/request_code.h"
#include "core/io/gzip.h"
#include "tests/support/errors.h"

namespace remesh::api {
namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr std::string_view kSheet = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nf 1 2 3\nf 1 3 4\n";
/// The same square, a quarter higher, with a tip of half a unit in its middle.
constexpr std::string_view kTent =
    "v 0 0 0.25\nv 2 0 0.25\nv 2 2 0.25\nv 0 2 0.25\nv 1 1 0.5\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";

struct Part {
  std::string name, content;
  bool is_file = true;
};

std::string form(const std::vector<Part>& parts) {
  std::string body;
  for (const Part& part : parts)
    body += "--b\r\nContent-Disposition: form-data; name=\"" + part.name + "\"" +
            (part.is_file ? "; filename=\"" + part.name + "\"" : "") + "\r\n\r\n" + part.content + "\r\n";
  return body + "--b--\r\n";
}

Response compared(const std::vector<Part>& parts, Fields query = {}, std::string accept = "") {
  const std::string body = form(parts);
  RunControl control;
  return run_compare({body, "multipart/form-data; boundary=b", "", std::move(accept), std::move(query)}, {}, control);
}
const std::vector<Part> kTwo{{"a", std::string(kSheet)}, {"b", std::string(kTent)}};

TEST(comparison, the_answer_has_both_directions_with_their_places) {
  const Response response = compared(kTwo);
  EXPECT_EQ(response.content_type, "application/json");
  EXPECT_EQ(response.done->input_faces, 6);
  const json answer = json::parse(response.body);
  // The tip is half a unit over the sheet, and the corners of the sheet are a quarter below the tent.
  EXPECT_NEAR(answer["b_to_a"]["distance"].get<double>(), 0.5, 1e-12);
  EXPECT_GE(answer["b_to_a"]["bound"].get<double>(), 0.5);
  EXPECT_EQ(answer["b_to_a"]["at"], json({1.0, 1.0, 0.5}));
  EXPECT_GE(answer["a_to_b"]["bound"].get<double>(), 0.25);
  EXPECT_EQ(answer["a_to_b"]["coarse"], false);
  EXPECT_EQ(answer["a_to_b"]["beyond"], nullptr);
  EXPECT_EQ(answer["within"], nullptr);
  EXPECT_EQ(answer["tolerance"], nullptr);
  EXPECT_DOUBLE_EQ(answer["diagonal"].get<double>(), std::sqrt(4 + 4 + 0.25));
}

TEST(comparison, a_tolerance_of_the_query_or_the_form_asks_for_yes_or_no) {
  const json yes = json::parse(compared(kTwo, {{"tolerance", "0.51"}}).body);
  EXPECT_EQ(yes["within"], true);
  EXPECT_EQ(yes["tolerance"], 0.51);
  EXPECT_EQ(yes["b_to_a"]["beyond"], json({{"count", 0}, {"faces", json::array()}}));
  std::vector<Part> parts = kTwo;
  parts.push_back({"tolerance", "0.49\n", false});
  const json no = json::parse(compared(parts).body);
  EXPECT_EQ(no["within"], false);
  // All four faces of the tent have the tip.
  EXPECT_EQ(no["b_to_a"]["beyond"]["count"], 4);
  EXPECT_EQ(no["b_to_a"]["beyond"]["faces"].size(), 4);
}

TEST(comparison, the_meshes_may_have_any_format_and_be_compressed) {
  RunControl control;
  const json answer =
      json::parse(compared({{"a", gzip(kSheet, control)},
                            {"b", R"({"vertices":[[0,0,0],[2,0,0],[2,2,0],[0,2,0]],"faces":[[0,1,2,3]]})"}})
                      .body);
  EXPECT_LE(answer["a_to_b"]["bound"].get<double>(), 1e-11);
  EXPECT_LE(answer["b_to_a"]["bound"].get<double>(), 1e-11);
}

TEST(comparison, what_is_wrong_is_told) {
  const auto error = [](const std::vector<Part>& parts, Fields query = {}, std::string accept = "") {
    return test::error_of([&] { compared(parts, std::move(query), std::move(accept)); });
  };
  const std::string sheet(kSheet);
  EXPECT_EQ(error({{"a", sheet}}).code, RequestCode::kMalformedMultipart);
  EXPECT_THAT(error({{"a", sheet}}).what(), HasSubstr("\"b\""));
  EXPECT_EQ(error({{"a", sheet}, {"a", sheet}, {"b", sheet}}).code, RequestCode::kMalformedMultipart);
  EXPECT_EQ(error({{"a", sheet}, {"b", sheet}, {"mesh", sheet}}).code, RequestCode::kMalformedMultipart);
  EXPECT_EQ(error({{"a", sheet}, {"b", ""}}).code, Code::kEmptyMesh);
  const Error second = error({{"a", sheet}, {"b", sheet + "f 1 2 9\n"}});
  EXPECT_EQ(second.code, Code::kIndexOutOfRange);
  EXPECT_EQ(second.line, 7u);
  EXPECT_THAT(second.what(), HasSubstr("in the part \"b\""));
  EXPECT_EQ(error(kTwo, {{"refine", "false"}}).code, RequestCode::kUnknownOption);
  for (const char* const bad : {"0", "-1", "x", "", "inf", "1e999"}) {
    const Error option = error(kTwo, {{"tolerance", bad}});
    EXPECT_EQ(option.code, Code::kInvalidOption) << bad;
    EXPECT_EQ(option.option, "tolerance");
  }
  EXPECT_EQ(error(kTwo, {{"tolerance", "1"}, {"tolerance", "1"}}).code, Code::kInvalidOption);
  EXPECT_EQ(error(kTwo, {}, "image/png").code, Code::kNotAcceptable);
  EXPECT_EQ(error({{"a", sheet},
                   {"b", R"({"mesh":{"vertices":[[0,0,0],[2,0,0],[2,2,0]],"faces":[[0,1,2]]},)"
                         R"("options":{"refine":false}})"}})
                .code,
            Code::kInvalidOption);
  EXPECT_EQ(test::error_of([&] {
              RunControl control;
              run_compare({sheet, "model/obj", "", "", {}}, {}, control);
            }).code,
            Code::kUnsupportedMediaType);
}

TEST(comparison, it_can_be_cancelled) {
  RunControl control;
  control.cancel();
  const std::string body = form(kTwo);
  EXPECT_EQ(test::error_of([&] {
              run_compare({body, "multipart/form-data; boundary=b", "", "", {}}, {}, control);
            }).code,
            Code::kCancelled);
}

}  // namespace
}  // namespace remesh::api
