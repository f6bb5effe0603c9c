#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <nlohmann/json.hpp>

#include "api/operations.h"
#include "api/options.h"
#include "api/request_code.h"

namespace remesh::api {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

TEST(capabilities, they_tell_every_option_and_format) {
  const json answer = json::parse(capabilities({}).body);
  EXPECT_EQ(answer["options"].size(), option_table().size());
  const auto names = [&](const char* direction) {
    std::vector<std::string> all;
    for (const json& format : answer["formats"][direction]) all.push_back(format["name"]);
    return all;
  };
  EXPECT_EQ(names("input"), (std::vector<std::string>{"obj", "json", "stl", "ply", "off", "vtu", "msh", "mesh", "glb",
                                                      "3mf", "inp", "bdf"}));
  EXPECT_EQ(names("output"), (std::vector<std::string>{"obj", "json", "stl", "stl_ascii", "ply", "off", "vtu", "msh",
                                                       "mesh", "smesh", "ply_ascii", "glb"}));
  EXPECT_EQ(answer["formats"]["input"][0]["media_type"], "model/obj");
}

/// Returns what the capabilities say of one option, without its description, which must not be empty.
json option_told(std::string_view name) {
  const json answer = json::parse(capabilities({}).body);
  for (json option : answer["options"]) {
    if (option["name"] != name) continue;
    EXPECT_FALSE(option["description"].get<std::string>().empty()) << name;
    option.erase("description");
    return option;
  }
  ADD_FAILURE() << "nothing is told of " << name;
  return {};
}

TEST(capabilities, an_option_tells_its_type_default_bounds_and_words_and_nothing_it_has_not) {
  EXPECT_EQ(option_told("refine"),
            json::parse(R"({"name": "refine", "group": "result", "type": "boolean", "default": true})"));
  EXPECT_EQ(option_told("normal_tolerance"),
            json::parse(R"({"name": "normal_tolerance", "group": "expert", "type": "number",
      "default": 1e-6, "minimum": 0, "maximum": 0.5})"));
  EXPECT_EQ(option_told("max_edge_length"),
            json::parse(R"({"name": "max_edge_length", "group": "size", "type": "number",
      "default": null, "unset": "none", "exclusive_minimum": 0, "excludes": "max_edge_fraction"})"));
  EXPECT_EQ(option_told("max_output_faces"),
            json::parse(R"({"name": "max_output_faces", "group": "size", "type": "integer",
      "default": null, "unset": "none", "minimum": 1})"));
  EXPECT_EQ(option_told("barriers"), json::parse(R"({"name": "barriers", "group": "expert", "type": "string",
      "default": "object,group,material", "values": ["object", "group", "material"], "is_list": true})"));
  EXPECT_EQ(option_told("preset"),
            json::parse(R"({"name": "preset", "group": "result", "type": "string", "default": null,
      "unset": "none", "values": ["volume", "exact"]})"));
  EXPECT_EQ(option_told("surface_tolerance"),
            json::parse(R"({"name": "surface_tolerance", "group": "curved", "type": "number",
      "default": null, "unset": "auto", "minimum": 0, "excludes": "surface_tolerance_fraction"})"));
  EXPECT_EQ(option_told("elements_per_circle"),
            json::parse(R"({"name": "elements_per_circle", "group": "curved", "type": "number",
      "default": null, "unset": "auto", "minimum": 3, "maximum": 1000, "values": ["none"]})"));
}

TEST(capabilities, options_stand_in_the_order_of_their_groups_each_in_one_sentence) {
  const json document = json::parse(openapi().body);
  const json& told = document["components"]["schemas"]["Capabilities"]["properties"]["options"]["items"]["properties"];
  const json answer = json::parse(capabilities({}).body);
  std::vector<std::string> groups;
  for (const json& option : answer["options"]) {
    if (groups.empty() || groups.back() != option["group"]) groups.push_back(option["group"]);
    const std::string text = option["description"];
    EXPECT_EQ(text.find(". "), std::string::npos) << text;
    EXPECT_LT(text.size(), 250u) << text;
  }
  EXPECT_EQ(json(groups), told["group"]["enum"]);
}

TEST(capabilities, what_is_told_of_an_option_is_what_it_takes) {
  const auto is_taken = [](const std::string& name, const json& value) {
    try {
      OptionReader().add(name, value.is_string() ? value.get<std::string>() : value.dump());
      return true;
    } catch (const Error&) {
      return false;
    }
  };
  const json answer = json::parse(capabilities({}).body);
  for (const json& option : answer["options"]) {
    SCOPED_TRACE(option.dump());
    const std::string name = option["name"];
    EXPECT_TRUE(option["default"].is_null() || is_taken(name, option["default"]));
    EXPECT_TRUE(!option.contains("unset") || is_taken(name, option["unset"]));
    for (const json& word : option.value("values", json::array())) EXPECT_TRUE(is_taken(name, word));
    if (option.contains("minimum")) {
      EXPECT_TRUE(is_taken(name, option["minimum"]));
      EXPECT_FALSE(is_taken(name, option["minimum"].get<double>() - 1e-3));
    }
    if (option.contains("exclusive_minimum")) {
      EXPECT_FALSE(is_taken(name, option["exclusive_minimum"]));
      EXPECT_TRUE(is_taken(name, option["exclusive_minimum"].get<double>() + 1e-3));
    }
    if (option.contains("maximum")) {
      EXPECT_TRUE(is_taken(name, option["maximum"]));
      EXPECT_FALSE(is_taken(name, option["maximum"].get<double>() + 1e-3));
    }
  }
}

TEST(capabilities, every_limit_is_told_under_its_own_name) {
  const Limits limits{
      1, {2, 3}, {4, 5}, 6, 7, std::chrono::milliseconds(8500), {8, 9, std::chrono::milliseconds(10'500)}};
  const Response response = capabilities(limits);
  EXPECT_EQ(response.status, 200);
  EXPECT_EQ(response.content_type, "application/json");
  EXPECT_EQ(json::parse(response.body)["limits"],
            json::parse(R"({"max_body": 1, "max_decompressed": 2, "max_ratio": 3, "max_vertices": 4, "max_faces": 5,
                            "max_output_faces": 6, "workers": 7, "request_timeout_s": 8.5,
                            "max_queued_large": 8, "max_queued_small_bytes": 9, "max_queued_small_wait_s": 10.5,
                            "max_distance_from_middle": 4.49423283715579e307, "min_extent": 2.2250738585072014e-308,
                            "min_width_of_length": 7.888609052210118e-31})"));
}

TEST(openapi, its_parameters_are_the_table_of_options) {
  const json document = json::parse(openapi().body);
  EXPECT_THAT(document["openapi"].get<std::string>(), StartsWith("3.1"));
  const json answer = json::parse(capabilities({}).body);
  for (const json& option : answer["options"]) {
    const std::string name = option["name"];
    SCOPED_TRACE(name);
    const json& parameter = document["components"]["parameters"][name];
    ASSERT_EQ(parameter["name"], name);
    const json& schema = parameter["schema"];
    EXPECT_EQ(schema["type"], option["type"]);
    EXPECT_EQ(schema.value("default", json()), option["default"]);
    EXPECT_EQ(schema.value("minimum", json()), option.value("minimum", json()));
    EXPECT_EQ(schema.value("exclusiveMinimum", json()), option.value("exclusive_minimum", json()));
    EXPECT_EQ(schema.value("maximum", json()), option.value("maximum", json()));
    if (parameter.contains("example")) {
      OptionReader reader;
      if (name == "max_hole_edges") reader.add("repair", "+holes");
      const json& example = parameter["example"];
      EXPECT_NO_THROW(reader.add(name, example.is_string() ? example.get<std::string>() : example.dump()));
      EXPECT_NO_THROW(reader.check());
    }
    if (option.contains("excludes")) {
      EXPECT_THAT(parameter["description"].get<std::string>(),
                  AllOf(HasSubstr("Excludes"), HasSubstr("`" + option["excludes"].get<std::string>() + "`")));
    }
    ASSERT_TRUE(document["components"]["schemas"]["Options"]["properties"].contains(name));
    const json& member = document["components"]["schemas"]["Options"]["properties"][name];
    for (const char* bound : {"minimum", "exclusiveMinimum", "maximum"})
      EXPECT_EQ(member.value(bound, json()), schema.value(bound, json())) << bound;
    if (option.contains("unset") && (option["type"] == "number" || option["type"] == "integer")) {
      std::string words = option["unset"];
      for (const json& word : option.value("values", json::array())) words += "|" + word.get<std::string>();
      const bool is_one = !option.contains("values");
      EXPECT_EQ(member["pattern"], is_one ? "^" + words + "$" : "^(" + words + ")$");
    }
    for (const char* path : {"/v1/remesh", "/v1/analyze"}) {
      const json& parameters = document["paths"][path]["post"]["parameters"];
      const bool is_listed = std::find(parameters.begin(), parameters.end(),
                                       json{{"$ref", "#/components/parameters/" + name}}) != parameters.end();
      // An analysis is JSON always.
      EXPECT_EQ(is_listed, name != "format" || path == std::string("/v1/remesh")) << path;
    }
  }
}

// Every "$ref" in a document, as a JSON pointer.
void collect_references(const json& node, std::vector<std::string>& references) {
  for (const auto& [key, value] : node.items()) {
    if (key == "$ref" && value.is_string()) references.push_back(value.get<std::string>().substr(1));
    if (value.is_structured()) collect_references(value, references);
  }
}

TEST(openapi, every_reference_has_its_target) {
  const json document = json::parse(openapi().body);
  std::vector<std::string> references;
  collect_references(document, references);
  EXPECT_GT(references.size(), 50u);
  for (const std::string& reference : references)
    EXPECT_TRUE(document.contains(json::json_pointer(reference))) << reference;
}

TEST(openapi, it_names_every_code_and_every_status) {
  const json document = json::parse(openapi().body);
  const std::string text = document["components"]["responses"]["Problem"]["description"];
  for (int c = 0; c < kCodeCount; ++c) {
    const Problem problem = to_problem(Error(static_cast<Code>(c), Stage::kRead, "x"));
    if (problem.status == 406 || problem.status == 415) continue;  // the text calls these the usual
    EXPECT_THAT(text, HasSubstr("`" + problem.code + "`"));
    EXPECT_THAT(text, HasSubstr(std::to_string(problem.status))) << problem.code;
  }
}

TEST(openapi, its_problems_are_as_they_are_sent) {
  const json document = json::parse(openapi().body);
  const json& content = document["components"]["responses"]["Problem"]["content"]["application/problem+json"];
  const std::map<std::string, Code> codes{{"index_out_of_range", Code::kIndexOutOfRange},
                                          {"output_too_large", Code::kOutputTooLarge},
                                          {"invalid_option", Code::kInvalidOption}};
  EXPECT_EQ(content["examples"].size(), codes.size());
  for (const auto& [name, code] : codes) {
    const json& shown = content["examples"][name]["value"];
    Error error(code, Stage::kRead, shown["detail"].get<std::string>());
    if (shown.contains("element")) error.at_element(shown["element"]);
    if (shown.contains("option")) error.for_option(shown["option"]);
    if (shown.contains("limit")) error.with_limit(shown["limit"]);
    const Response response = to_response(to_problem(error), shown["request_id"].get<std::string>());
    EXPECT_EQ(response.status, shown["status"]);
    EXPECT_EQ(json::parse(response.body), shown);
  }
}

}  // namespace
}  // namespace remesh::api
