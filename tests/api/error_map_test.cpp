#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "api/operations.h"
#include "api/request_code.h"

namespace remesh::api {
namespace {

TEST(error_map, every_code_has_the_status_of_the_contract) {
  const std::map<std::string, int> contract{
      {"malformed_request", 400},      {"malformed_json", 400},   {"malformed_multipart", 400},
      {"invalid_option", 400},         {"unknown_option", 400},   {"not_acceptable", 406},
      {"body_too_large", 413},         {"mesh_too_large", 413},   {"decompressed_too_large", 413},
      {"unsupported_media_type", 415}, {"invalid_mesh", 422},     {"index_out_of_range", 422},
      {"nonfinite_coordinate", 422},   {"coordinate_range", 422}, {"empty_mesh", 422},
      {"output_too_large", 422},       {"cancelled", 499},        {"internal", 500},
      {"verification_failed", 500},    {"out_of_memory", 413},    {"timeout", 504}};
  std::map<std::string, int> table;
  for (int c = 0; c < kCodeCount; ++c) {
    const Problem problem = to_problem(Error(static_cast<Code>(c), Stage::kRead, "x"));
    table[problem.code] = problem.status;
  }
  EXPECT_EQ(table.size(), static_cast<std::size_t>(kCodeCount)) << "two codes have one name";
  EXPECT_EQ(table, contract);
}

TEST(error_map, a_problem_says_where) {
  Error error(Code::kIndexOutOfRange, Stage::kRead, "face 3 names vertex \"9\"");
  error.at_line(12).at_byte(84).at_element(3).with_limit(8).for_option("repair");
  const Response response = to_response(to_problem(error), "an-id");
  EXPECT_EQ(response.status, 422);
  EXPECT_EQ(response.content_type, "application/problem+json");
  const nlohmann::json expected{{"type", "urn:remeshd:problem:index_out_of_range"},
                                {"title", "Index out of range"},
                                {"status", 422},
                                {"detail", "face 3 names vertex \"9\""},
                                {"code", "index_out_of_range"},
                                {"request_id", "an-id"},
                                {"line", 12},
                                {"byte", 84},
                                {"element", 3},
                                {"option", "repair"},
                                {"limit", 8}};
  EXPECT_EQ(nlohmann::json::parse(response.body), expected);
}

TEST(error_map, what_does_not_apply_is_left_out) {
  Problem not_found;
  not_found.status = 404;
  not_found.code = "not_found";
  const nlohmann::json problem = nlohmann::json::parse(to_response(not_found, "").body);
  for (const char* member : {"request_id", "line", "byte", "element", "option", "limit"})
    EXPECT_FALSE(problem.contains(member)) << member;
}

TEST(error_map, an_unknown_option_is_named_even_where_its_name_is_empty) {
  const Error error =
      Error(as_code(RequestCode::kUnknownOption), Stage::kRead, "there is no option \"\"").for_option("");
  EXPECT_EQ(nlohmann::json::parse(to_response(to_problem(error), "an-id").body)["option"], "");
}

TEST(error_map, an_internal_error_tells_nothing_of_itself) {
  const Response response = to_response(to_problem(Error(Code::kInternal, Stage::kWeld, "secret at 0x1234")), "an-id");
  EXPECT_EQ(response.body.find("secret"), std::string::npos);
}

}  // namespace
}  // namespace remesh::api
