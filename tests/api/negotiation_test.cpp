#include "api/negotiation.h"

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "tests/support/errors.h"

namespace remesh::api {
namespace {

Format output(std::string_view accept, Format input = Format::kObj) {
  return choose_output_format({}, accept, input).format;
}

bool is_refused(std::string_view accept, Format input = Format::kObj) {
  try {
    output(accept, input);
  } catch (const Error& error) {
    return error.code == Code::kNotAcceptable;
  }
  return false;
}

TEST(negotiation, a_content_type_names_a_format_whatever_its_case_and_parameters) {
  EXPECT_EQ(format_of_content_type("model/obj"), Format::kObj);
  EXPECT_EQ(format_of_content_type("Application/JSON ; charset=utf-8"), Format::kJson);
  EXPECT_EQ(format_of_content_type("model/stl"), Format::kStl);
  for (const std::string_view generic :
       {"", "application/x-www-form-urlencoded", "application/octet-stream", "text/plain", "image/png"}) {
    EXPECT_EQ(format_of_content_type(generic), std::nullopt) << generic;
  }
}

TEST(negotiation, without_a_named_format_the_content_tells) {
  EXPECT_EQ(choose_input_format({}, "# a comment\nv 0 0 0\n"), Format::kObj);
  EXPECT_EQ(choose_input_format({}, " \n{\"vertices\":[]}"), Format::kJson);
  EXPECT_EQ(choose_input_format(Format::kObj, "{"), Format::kObj);
}

TEST(negotiation, a_format_that_is_not_read_is_an_unsupported_media_type) {
  for (const auto& [named, content] : {std::pair<std::optional<Format>, std::string_view>(Format::kSmesh, "v 0 0 0"),
                                       {Format::kSmesh, "ply\nformat ascii 1.0\n"}}) {
    try {
      choose_input_format(named, content);
      ADD_FAILURE();
    } catch (const Error& error) {
      EXPECT_EQ(error.code, Code::kUnsupportedMediaType);
    }
  }
}

TEST(negotiation, a_file_of_another_kind_is_told_what_it_is_unless_a_format_is_named) {
  const Error error = test::error_of([] { choose_input_format({}, "%PDF-1.5 a drawing"); });
  EXPECT_EQ(error.code, Code::kUnsupportedMediaType);
  EXPECT_STREQ(error.what(),
               "the content looks like PDF; export the part itself as STL; the formats that can be read are obj, json, "
               "stl, ply, off, vtu, msh, mesh, glb, 3mf, inp, bdf, also compressed by gzip");
  EXPECT_EQ(choose_input_format(Format::kObj, "# vtk DataFile of old\nv 0 0 0\n"), Format::kObj);
}

TEST(negotiation, the_option_wins_over_accept) {
  EXPECT_EQ(choose_output_format(Format::kObj, "application/json", Format::kJson).format, Format::kObj);
  EXPECT_EQ(choose_output_format(Format::kVtu, "model/obj", Format::kObj).format, Format::kVtu);
}

TEST(negotiation, a_format_is_asked_for_by_name_if_it_weighs_more_than_any_other) {
  const auto is_by_name = [](std::string_view accept) {
    return choose_output_format({}, accept, Format::kStl).is_by_name;
  };
  EXPECT_TRUE(choose_output_format(Format::kStl, "*/*", Format::kStl).is_by_name);
  for (const std::string_view named : {"model/stl", "model/stl, */*;q=0.9", "model/stl;q=0.5, */*;q=0.1"})
    EXPECT_TRUE(is_by_name(named)) << named;
  for (const std::string_view open : {"", "*/*", "model/*", "model/stl, */*", "model/stl;q=0.5, */*"})
    EXPECT_FALSE(is_by_name(open)) << open;
}

TEST(negotiation, only_a_format_that_was_not_asked_for_by_name_may_come_as_text) {
  EXPECT_EQ(rounding_for({Format::kStl, false}), OutputRounding::kIfHeld);
  EXPECT_EQ(rounding_for({Format::kStl, true}), OutputRounding::kRequired);
  EXPECT_EQ(content_type(text_form(Format::kStl)), "model/stl; charset=utf-8");
  EXPECT_EQ(content_type(Format::kStl), "model/stl");
}

TEST(negotiation, anything_counts_as_absent) {
  for (const std::string_view any : {"", " ", "*/*", "text/html, */*;q=0.8", "*/*;q=0.1"}) {
    EXPECT_EQ(output(any, Format::kObj), Format::kObj) << any;
    EXPECT_EQ(output(any, Format::kJson), Format::kJson) << any;
  }
  EXPECT_EQ(output("application/json, text/plain, */*"), Format::kObj) << "this is the default of axios";
  EXPECT_EQ(output("model/stl, */*", Format::kPly), Format::kPly);
  EXPECT_EQ(output("model/stl, */*;q=0.9", Format::kPly), Format::kStl);
  EXPECT_EQ(output("application/x-ply;q=0.5, model/stl, */*", Format::kPly), Format::kStl);
}

TEST(negotiation, the_heaviest_of_the_named_is_taken) {
  EXPECT_EQ(output("model/obj;q=0.5, application/json"), Format::kJson);
  EXPECT_EQ(output("application/json;q=0.2,model/obj ; Q=0.3", Format::kJson), Format::kObj);
  EXPECT_EQ(output("application/json, model/obj"), Format::kObj);
  EXPECT_EQ(output("application/json, model/obj", Format::kJson), Format::kJson);
  EXPECT_EQ(output("model/*", Format::kJson), Format::kObj);
  EXPECT_EQ(output("model/stl, application/json;q=0.1"), Format::kStl);
  EXPECT_EQ(output("model/step, application/json;q=0.1"), Format::kJson);
}

TEST(negotiation, anything_outweighs_what_is_named_with_less) {
  EXPECT_EQ(output("application/json;q=0.2, */*;q=0.9"), Format::kObj);
  EXPECT_EQ(output("application/json;q=0.2, */*;q=0.9", Format::kJson), Format::kObj);
  EXPECT_EQ(output("application/json;q=0.9, */*;q=0.9"), Format::kObj);
}

TEST(negotiation, what_cannot_be_written_is_not_acceptable) {
  EXPECT_TRUE(is_refused("model/step"));
  EXPECT_TRUE(is_refused("text/html"));
  EXPECT_TRUE(is_refused("application/json;q=0"));
  EXPECT_TRUE(is_refused("*/*;q=0"));
}

TEST(negotiation, a_weight_of_nothing_refuses_a_format) {
  EXPECT_EQ(output("model/obj;q=0, */*"), Format::kJson);
  EXPECT_EQ(output("application/json;q=0, */*", Format::kJson), Format::kObj);
}

}  // namespace
}  // namespace remesh::api
