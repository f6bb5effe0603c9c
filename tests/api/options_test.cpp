#include "api/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "api/request_code.h"
#include "core/base/error.h"
#include "tests/support/errors.h"

namespace remesh::api {
namespace {

using test::error_of;
using testing::HasSubstr;

RequestOptions read(std::string_view name, std::string_view text, ValueKind kind = ValueKind::kUntyped) {
  OptionReader reader;
  reader.add(name, text, kind);
  return reader.options();
}

void expect_invalid(std::string_view name, std::string_view text, ValueKind kind = ValueKind::kUntyped) {
  SCOPED_TRACE(std::string(name) + "=" + std::string(text));
  const Error error = error_of([&] { read(name, text, kind); });
  EXPECT_EQ(error.code, Code::kInvalidOption);
  EXPECT_EQ(error.option, name);
}

TEST(options, booleans_are_read_as_languages_write_them) {
  for (const char* text : {"true", "True", "TRUE", "1"})
    EXPECT_TRUE(read("keep_boundary_vertices", text).core.keep_boundary_vertices) << text;
  for (const char* text : {"false", "False", "0"}) EXPECT_FALSE(read("refine", text).core.refine) << text;
  for (const char* text : {"yes", "t", "2", "truee", " true"}) expect_invalid("refine", text);
  expect_invalid("refine", "1", ValueKind::kNumber);
  expect_invalid("refine", "true", ValueKind::kString);
}

TEST(options, an_empty_value_is_told_as_such) {
  for (const char* name : {"refine", "max_edge_length", "repair", "format", "max_output_faces", "reference_axis"}) {
    const Error error = error_of([&] { read(name, ""); });
    EXPECT_EQ(error.code, Code::kInvalidOption) << name;
    EXPECT_EQ(error.option, name);
    EXPECT_THAT(error.what(), HasSubstr(std::string(name) + " is empty"));
  }
}

TEST(options, the_table_has_every_option_of_the_contract_with_its_default) {
  const std::map<std::string_view, std::string> contract{{"refine", "true"},
                                                         {"min_angle_deg", "25"},
                                                         {"max_radius_edge_ratio", "none"},
                                                         {"target_faces", "none"},
                                                         {"target_edge_length", "none"},
                                                         {"max_edge_length", "none"},
                                                         {"max_edge_fraction", "none"},
                                                         {"max_area", "none"},
                                                         {"min_edge_length", "auto"},
                                                         {"defeature_size", "auto"},
                                                         {"proximity", "0"},
                                                         {"gradation", "auto"},
                                                         {"max_output_faces", "none"},
                                                         {"split_boundaries", "true"},
                                                         {"keep_boundary_vertices", "false"},
                                                         {"plane_tolerance", "auto"},
                                                         {"feature_angle_deg", "30"},
                                                         {"surface_tolerance", "auto"},
                                                         {"surface_tolerance_fraction", "none"},
                                                         {"elements_per_circle", "auto"},
                                                         {"circle_fit", "inscribed"},
                                                         {"normal_tolerance", "1e-06"},
                                                         {"weld_tolerance", "0"},
                                                         {"repair", "duplicates,degenerate,t_junctions,winding,seams"},
                                                         {"max_hole_edges", "none"},
                                                         {"barriers", "object,group,material"},
                                                         {"local_origin", "false"},
                                                         {"reference_axis", "dominant_edge"},
                                                         {"preset", "none"},
                                                         {"format", "auto"},
                                                         {"label", "auto"},
                                                         {"names", "portable"},
                                                         {"stl_solids", "label"},
                                                         {"glb_colours", "label"},
                                                         {"ply_labels", "auto"},
                                                         {"msh_version", "2.2"}};
  std::map<std::string_view, std::string> table;
  for (const OptionSpec& spec : option_table()) table[spec.name] = option_text(spec, with_defaults(RequestOptions{}));
  EXPECT_EQ(table, contract);
}

TEST(options, what_is_left_open_gets_the_value_that_is_used) {
  const auto used = [](std::initializer_list<std::pair<std::string_view, std::string_view>> given) {
    OptionReader reader;
    for (const auto& [name, text] : given) reader.add(name, text);
    return with_defaults(reader.options()).core;
  };
  EXPECT_EQ(used({{"refine", "true"}}).min_angle_deg, 25.0);
  EXPECT_EQ(used({{"refine", "true"}}).gradation, std::nullopt);
  EXPECT_EQ(used({{"refine", "true"}, {"proximity", "2"}}).gradation, 1.5);
  EXPECT_EQ(used({{"refine", "true"}, {"proximity", "2"}, {"gradation", "1.2"}}).gradation, 1.2);
  EXPECT_EQ(used({{"refine", "true"}, {"min_angle_deg", "0"}}).min_angle_deg, 0.0);
  // One of the two forms of the bound, never both: they exclude each other.
  EXPECT_EQ(used({{"refine", "true"}, {"max_radius_edge_ratio", "1.2"}}).min_angle_deg, std::nullopt);
  EXPECT_EQ(used({{"refine", "true"}, {"max_radius_edge_ratio", "1.2"}}).max_radius_edge_ratio, 1.2);
  EXPECT_EQ(used({{"refine", "true"}, {"max_edge_fraction", "0.02"}}).max_edge_length, std::nullopt);
  EXPECT_EQ(used({{"refine", "false"}, {"proximity", "1"}}).min_angle_deg, std::nullopt);
  EXPECT_EQ(used({{"refine", "false"}, {"proximity", "1"}}).gradation, std::nullopt);
}

TEST(options, every_option_reads_its_example_and_shows_it_again) {
  for (const OptionSpec& spec : option_table()) {
    SCOPED_TRACE(spec.name);
    const RequestOptions options = read(spec.name, spec.example);
    const std::string shown = option_text(spec, options);
    EXPECT_NE(shown, option_text(spec, RequestOptions{}));
    EXPECT_EQ(option_text(spec, read(spec.name, shown)), shown);
  }
}

TEST(options, an_option_but_a_preset_sets_its_own_field_only) {
  for (const OptionSpec& spec : option_table()) {
    if (spec.name == "preset") continue;
    const RequestOptions options = read(spec.name, spec.example);
    for (const OptionSpec& other : option_table()) {
      if (other.name == spec.name) continue;
      EXPECT_EQ(option_text(other, options), option_text(other, RequestOptions{}))
          << spec.name << " set " << other.name;
    }
  }
}

using Given = std::vector<std::pair<std::string_view, std::string_view>>;

RequestOptions read_all(const Given& given) {
  OptionReader reader;
  for (const auto& [name, text] : given) reader.add(name, text);
  reader.check();
  return reader.options();
}

/// The options that differ from the defaults, with their values.
std::map<std::string_view, std::string> changed(const RequestOptions& options) {
  std::map<std::string_view, std::string> found;
  for (const OptionSpec& spec : option_table()) {
    const std::string text = option_text(spec, options);
    if (text != option_text(spec, RequestOptions{})) found[spec.name] = text;
  }
  return found;
}

TEST(options, names_are_any_that_are_not_empty) {
  EXPECT_EQ(read("ply_labels", "auto").ply_labels, std::nullopt);
  EXPECT_EQ(read("ply_labels", "none").ply_labels, std::vector<std::string>());
  EXPECT_EQ(read("ply_labels", "part id,zone").ply_labels, (std::vector<std::string>{"part id", "zone"}));
  for (const std::string& text : {std::string(), std::string("a,"), std::string(101, 'a'), std::string(300, ',')})
    EXPECT_THROW(read("ply_labels", text), Error) << text;
}

TEST(options, the_exact_preset_leaves_facets_and_boundaries_as_they_are) {
  const std::map<std::string_view, std::string> expected{
      {"preset", "exact"}, {"feature_angle_deg", "0"}, {"split_boundaries", "false"}, {"defeature_size", "0"}};
  EXPECT_EQ(changed(read("preset", "exact")), expected);
  EXPECT_EQ(changed(read("preset", "exact", ValueKind::kString)), expected);
  EXPECT_TRUE(changed(read("preset", "none")).empty());
  EXPECT_TRUE(changed(read("preset", "null", ValueKind::kNull)).empty());
}

TEST(options, the_preset_for_volume_meshing_sets_gaps_and_circles_and_leaves_the_bound_on_angles) {
  const std::map<std::string_view, std::string> expected{
      {"preset", "volume"}, {"proximity", "0.25"}, {"elements_per_circle", "16"}};
  EXPECT_EQ(changed(read("preset", "volume")), expected);
  const RequestOptions given = read_all({{"proximity", "0"}, {"preset", "volume"}, {"max_radius_edge_ratio", "1"}});
  EXPECT_EQ(given.core.proximity, 0);
  EXPECT_EQ(given.core.elements_per_circle, 16);
  EXPECT_EQ(given.core.max_radius_edge_ratio, 1);
}

TEST(options, what_is_given_goes_before_a_preset_in_either_order) {
  const Given orders[] = {{{"preset", "exact"}, {"feature_angle_deg", "45"}},
                          {{"feature_angle_deg", "45"}, {"preset", "exact"}}};
  for (const Given& given : orders) {
    const RequestOptions options = read_all(given);
    EXPECT_EQ(options.core.feature_angle_deg, 45);
    EXPECT_FALSE(options.core.split_boundaries);
  }
  // A default that is given is given.
  const RequestOptions options = read_all({{"split_boundaries", "true"}, {"preset", "exact"}});
  EXPECT_TRUE(options.core.split_boundaries);
  EXPECT_EQ(options.core.feature_angle_deg, 0);
}

TEST(options, a_preset_is_one_of_its_words) {
  for (const std::string_view text : {"", "volumes", "Exact", "exact,exact", "true"}) expect_invalid("preset", text);
  expect_invalid("preset", "exact", ValueKind::kList);
  expect_invalid("preset", "1", ValueKind::kNumber);
  EXPECT_THAT(error_of([] { read("preset", "volumes"); }).what(),
              HasSubstr("must be one of volume, exact, or none, not \"volumes\""));
  EXPECT_THAT(option_words(*find_option("preset")), testing::ElementsAre("volume", "exact"));
}

TEST(options, the_options_in_force_ask_for_the_same_again) {
  const RequestOptions used = read_all({{"preset", "exact"}, {"split_boundaries", "true"}, {"surface_tolerance", "0"}});
  Given again;
  std::vector<std::string> texts;
  texts.reserve(option_table().size());
  for (const OptionSpec& spec : option_table())
    again.emplace_back(spec.name, texts.emplace_back(option_text(spec, used)));
  EXPECT_EQ(changed(read_all(again)), changed(used));
}

TEST(options, the_surface_tolerance_may_be_found_from_the_input_a_length_or_0) {
  EXPECT_EQ(read("surface_tolerance", "auto").core.surface_tolerance, std::nullopt);
  EXPECT_EQ(read("surface_tolerance", "null", ValueKind::kNull).core.surface_tolerance, std::nullopt);
  EXPECT_EQ(read("surface_tolerance", "0").core.surface_tolerance, 0.0);
  EXPECT_EQ(read("surface_tolerance", "0.25").core.surface_tolerance, 0.25);
  expect_invalid("surface_tolerance", "none");
  expect_invalid("surface_tolerance", "-1e-300");
  EXPECT_EQ(read("surface_tolerance_fraction", "0").core.surface_tolerance_fraction, 0.0);
  EXPECT_EQ(read("surface_tolerance_fraction", "none").core.surface_tolerance_fraction, std::nullopt);
  expect_invalid("surface_tolerance_fraction", "auto");
  // An option that is left to the input excludes nothing.
  EXPECT_EQ(read_all({{"surface_tolerance", "auto"}, {"surface_tolerance_fraction", "0.001"}})
                .core.surface_tolerance_fraction,
            0.001);
  // 0 is a value, not the lack of one.
  EXPECT_EQ(error_of([] {
              read_all({{"surface_tolerance", "0"}, {"surface_tolerance_fraction", "0"}});
            }).option,
            "surface_tolerance_fraction");
}

TEST(options, numbers_are_correctly_rounded) {
  EXPECT_EQ(read("plane_tolerance", "0.1").core.plane_tolerance, 0.1);
  EXPECT_EQ(read("plane_tolerance", "2.2250738585072011e-308").core.plane_tolerance, 2.2250738585072011e-308);
  EXPECT_EQ(read("max_output_faces", "18446744073709551615").core.max_output_faces, 18446744073709551615u);
}

TEST(options, a_word_unsets_what_may_be_unset) {
  EXPECT_EQ(read("plane_tolerance", "auto").core.plane_tolerance, std::nullopt);
  EXPECT_EQ(read("max_area", "none").core.max_area, std::nullopt);
  EXPECT_EQ(read("max_area", "null", ValueKind::kNull).core.max_area, std::nullopt);
  EXPECT_EQ(read("min_angle_deg", "auto").core.min_angle_deg, std::nullopt);
  EXPECT_EQ(read("gradation", "auto").core.gradation, std::nullopt);
  expect_invalid("min_angle_deg", "none");  // 0 is no bound; "none" would have meant 25
  expect_invalid("proximity", "none");
  expect_invalid("proximity", "null", ValueKind::kNull);
}

TEST(options, what_is_no_number_is_refused) {
  for (const std::string_view text :
       {"", " ", "1 ", " 1", "1x", "0x10", "nan", "NaN", "inf", "-inf", "1e999", "1,5", "true"}) {
    expect_invalid("plane_tolerance", text);
    expect_invalid("weld_tolerance", text);
    expect_invalid("max_output_faces", text);
  }
  for (const std::string_view text : {"1.5", "1e-3", "-1", "-1.0", "0", "0.0", "18446744073709551616", "1e300"})
    expect_invalid("max_output_faces", text);
}

TEST(options, whole_numbers_are_integers_however_they_are_written) {
  for (const std::string_view text : {"1000", "1000.0", "1e3", "1E+3", "0.1e4"})
    EXPECT_EQ(read("max_output_faces", text).core.max_output_faces, 1000u) << text;
  EXPECT_EQ(read("max_output_faces", "9007199254740992.0").core.max_output_faces, std::uint64_t{1} << 53);
}

TEST(options, a_number_has_a_range_in_the_core_for_the_same_member_and_nothing_else_has) {
  std::size_t numbers = 0;
  for (const OptionSpec& spec : option_table()) {
    SCOPED_TRACE(spec.name);
    const bool is_number = spec.type == OptionType::kNumber || spec.type == OptionType::kInteger;
    ASSERT_EQ(number_range(spec.name) != nullptr, is_number);
    for (const NumberOption& number : number_options()) {
      if (number.name != spec.name) continue;
      ++numbers;
      std::visit(
          [&](auto member) {
            // The number of elements has words beside it.
            if (std::holds_alternative<ElementsField>(spec.field)) return;
            const auto* field = std::get_if<decltype(member)>(&spec.field);
            EXPECT_TRUE(field != nullptr && *field == member);
          },
          number.member);
    }
  }
  EXPECT_EQ(numbers, number_options().size());
}

TEST(options, ranges_hold_at_their_ends) {
  EXPECT_EQ(read("min_angle_deg", "0").core.min_angle_deg, 0.0);
  EXPECT_EQ(read("min_angle_deg", "33").core.min_angle_deg, 33.0);
  expect_invalid("min_angle_deg", "33.000001");
  expect_invalid("min_angle_deg", "-1e-9");
  for (const std::string_view name : {"max_edge_length", "max_edge_fraction", "max_area", "plane_tolerance"}) {
    expect_invalid(name, "0");
    expect_invalid(name, "-1");
  }
  EXPECT_EQ(read("min_edge_length", "0").core.min_edge_length, 0.0);
  EXPECT_EQ(read("min_edge_length", "auto").core.min_edge_length, std::nullopt);
  expect_invalid("min_edge_length", "-1e-9");
  expect_invalid("gradation", "1");
  EXPECT_EQ(read("max_radius_edge_ratio", "0.918").core.max_radius_edge_ratio, 0.918);
  expect_invalid("max_radius_edge_ratio", "0.917");
  EXPECT_EQ(read("proximity", "0").core.proximity, 0.0);
  expect_invalid("proximity", "-0.5");
  EXPECT_EQ(read("elements_per_circle", "3").core.elements_per_circle, 3.0);
  EXPECT_EQ(read("elements_per_circle", "1000").core.elements_per_circle, 1000.0);
  expect_invalid("elements_per_circle", "2.999");
  expect_invalid("elements_per_circle", "1000.001");
}

TEST(options, elements_per_circle_is_a_number_or_auto_or_none) {
  const auto automatic = read("elements_per_circle", "auto");
  EXPECT_TRUE(automatic.core.coarsens_fine_facets);
  EXPECT_EQ(automatic.core.elements_per_circle, std::nullopt);
  EXPECT_TRUE(read("elements_per_circle", "null", ValueKind::kNull).core.coarsens_fine_facets);
  for (const ValueKind kind : {ValueKind::kUntyped, ValueKind::kString}) {
    const auto none = read("elements_per_circle", "none", kind);
    EXPECT_FALSE(none.core.coarsens_fine_facets);
    EXPECT_EQ(none.core.elements_per_circle, std::nullopt);
    EXPECT_EQ(option_text(*find_option("elements_per_circle"), none), "none");
  }
  expect_invalid("elements_per_circle", "None");
  expect_invalid("elements_per_circle", "16", ValueKind::kString);
  EXPECT_THAT(error_of([] { read("elements_per_circle", "few"); }).what(),
              HasSubstr("must be a number from 3 to 1000, none, or auto, not \"few\""));
}

TEST(options, elements_per_circle_is_told_as_none_where_auto_does_not_act) {
  const auto told = [](const Given& given) {
    return option_text(*find_option("elements_per_circle"), with_defaults(read_all(given)));
  };
  EXPECT_EQ(told({}), "auto");
  EXPECT_EQ(told({{"circle_fit", "volume"}}), "auto");
  EXPECT_EQ(told({{"preset", "volume"}}), "16");
  EXPECT_EQ(told({{"preset", "volume"}, {"elements_per_circle", "auto"}}), "auto");
  const Given not_acting[] = {{{"elements_per_circle", "none"}},
                              {{"surface_tolerance", "0.1"}},
                              {{"surface_tolerance", "0"}},
                              {{"surface_tolerance_fraction", "0.001"}},
                              {{"refine", "false"}},
                              {{"split_boundaries", "false"}},
                              {{"keep_boundary_vertices", "true"}},
                              {{"preset", "exact"}},
                              {{"elements_per_circle", "auto"}, {"surface_tolerance", "0.1"}}};
  for (const Given& given : not_acting) EXPECT_EQ(told(given), "none") << given.back().first;
}

TEST(options, booleans_are_true_or_false) {
  EXPECT_FALSE(read("split_boundaries", "false").core.split_boundaries);
  for (const std::string_view text : {"yes", "", "truee"}) expect_invalid("split_boundaries", text);
}

TEST(options, words_are_read_in_any_order_each_once) {
  const Repair repair = read("repair", "inside_out,duplicates").core.repair;
  EXPECT_EQ(repair, (Repair{.duplicates = true,
                            .degenerate = false,
                            .t_junctions = false,
                            .winding = false,
                            .seams = false,
                            .inside_out = true}));
  EXPECT_EQ(read("barriers", "none").core.barriers, (Barriers{false, false, false}));
  for (const std::string_view text :
       {"", "duplicates,", "duplicates,duplicates", "none,duplicates", "duplicates degenerate"}) {
    expect_invalid("repair", text);
  }
}

TEST(options, words_with_signs_change_the_default) {
  Repair more;
  more.inside_out = true;
  Repair less;
  less.seams = false;
  Repair both = more;
  both.seams = both.winding = false;
  // A plus in a query string may have been decoded to a blank.
  for (const std::string_view text : {"+inside_out", " inside_out"}) {
    EXPECT_EQ(read("repair", text).core.repair, more) << text;
    EXPECT_EQ(read("repair", text, ValueKind::kString).core.repair, more) << text;
    EXPECT_EQ(read("repair", text, ValueKind::kList).core.repair, more) << text;
  }
  EXPECT_EQ(read("repair", "-seams").core.repair, less);
  for (const std::string_view text : {"+inside_out,-seams,-winding", "-winding, inside_out,-seams"})
    EXPECT_EQ(read("repair", text).core.repair, both) << text;
  EXPECT_EQ(read("repair", "+duplicates").core.repair, Repair{}) << "it is there already";
  EXPECT_EQ(read("repair", "-inside_out").core.repair, Repair{}) << "it was not there";
  EXPECT_EQ(read("barriers", "-group").core.barriers, (Barriers{true, false, true}));
  EXPECT_EQ(read("barriers", "-object,-group,-material").core.barriers, (Barriers{false, false, false}));
}

TEST(options, words_with_signs_and_words_without_do_not_mix) {
  for (const std::string_view text : {"+inside_out,seams", "winding,-seams", "duplicates, inside_out"}) {
    expect_invalid("repair", text);
    EXPECT_THAT(error_of([&] { read("repair", text); }).what(), HasSubstr("mixes words with a sign")) << text;
  }
  for (const std::string_view text :
       {"+", "-", "+none", "-none", "++seams", "+ seams", "+seams,-seams", "+seams,", ",+seams", "+seams ", "+,seams"})
    expect_invalid("repair", text);
}

TEST(options, a_word_that_is_not_known_is_an_error_that_names_those_that_are) {
  for (const std::string_view text : {"+unions", "-self_intersection", "imprint", "winding,imprint", " imprint"}) {
    expect_invalid("repair", text);
    const Error error = error_of([&] { read("repair", text); });
    for (const std::string_view word : option_words(*find_option("repair")))
      EXPECT_THAT(error.what(), HasSubstr(std::string(word))) << text;
  }
}

TEST(options, the_axis_is_a_word_or_a_direction) {
  EXPECT_EQ(read("reference_axis", "x").core.reference_axis, ReferenceAxis::kX);
  const Options given = read("reference_axis", "0,-1,2.5").core;
  EXPECT_EQ(given.reference_axis, ReferenceAxis::kGiven);
  EXPECT_EQ(given.reference_direction, (Vec3{0, -1, 2.5}));
  for (const std::string_view text : {"y", "1,2", "1,2,3,4", "0,0,0", "0,0,-0", "1,nan,0", "1,,0", ""}) {
    expect_invalid("reference_axis", text);
  }
}

TEST(options, json_types_must_fit) {
  EXPECT_EQ(read("plane_tolerance", "0.5", ValueKind::kNumber).core.plane_tolerance, 0.5);
  expect_invalid("plane_tolerance", "0.5", ValueKind::kString);
  expect_invalid("split_boundaries", "true", ValueKind::kString);
  expect_invalid("split_boundaries", "1", ValueKind::kNumber);
  expect_invalid("format", "1", ValueKind::kNumber);
  expect_invalid("plane_tolerance", "true", ValueKind::kBoolean);
  expect_invalid("plane_tolerance", "1,2", ValueKind::kList);
  EXPECT_EQ(read("msh_version", "4.1", ValueKind::kNumber).writing.msh_version, MshVersion::k41);
  expect_invalid("msh_version", "4", ValueKind::kNumber);
  EXPECT_EQ(read("repair", "winding", ValueKind::kList).core.repair.winding, true);
}

TEST(options, an_unknown_option_names_the_nearest) {
  const std::map<std::string_view, std::string_view> nearest{
      {"min_angle", "min_angle_deg"},  {"max_edge_lenght", "max_edge_length"}, {"Refine", "refine"},
      {"max_edge", "max_edge_length"}, {"maxEdgeLength", "max_edge_length"},   {"hausd", "surface_tolerance"},
      {"output_format", "format"}};
  for (const auto& [wrong, right] : nearest) {
    const Error error = error_of([&, w = wrong] { read(w, "1"); });
    EXPECT_EQ(error.code, RequestCode::kUnknownOption);
    EXPECT_EQ(error.option, wrong);
    EXPECT_THAT(error.what(), HasSubstr("\"" + std::string(right) + "\""));
  }
}

TEST(options, an_unknown_option_of_any_length_is_refused_with_a_short_message) {
  const Error error = error_of([] { read(std::string(1 << 20, 'x'), "1"); });
  EXPECT_EQ(error.code, RequestCode::kUnknownOption);
  EXPECT_LT(std::string_view(error.what()).size(), 300u);
}

TEST(options, a_nul_in_a_value_does_not_cut_off_the_message) {
  using namespace std::string_view_literals;
  const Error error = error_of([] { read("repair", "a\0b"sv, ValueKind::kString); });
  EXPECT_NE(std::string_view(error.what()).find("not \"a\\u0000b\""), std::string_view::npos) << error.what();
}

TEST(options, a_doubled_option_is_refused) {
  OptionReader reader;
  reader.add("refine", "false");
  const Error error = error_of([&] { reader.add("refine", "false"); });
  EXPECT_EQ(error.code, Code::kInvalidOption);
  EXPECT_EQ(error.option, "refine");
}

TEST(options, both_of_a_pair_are_refused_in_either_order) {
  const std::pair<std::string_view, std::string_view> pairs[] = {{"min_angle_deg", "max_radius_edge_ratio"},
                                                                 {"max_edge_length", "max_edge_fraction"},
                                                                 {"surface_tolerance", "surface_tolerance_fraction"}};
  for (const auto& [a, b] : pairs) {
    for (const auto& [first, second] : {std::pair(a, b), std::pair(b, a)}) {
      OptionReader reader;
      reader.add(first, "1");
      const Error error = error_of([&, s = second] { reader.add(s, "1"); });
      EXPECT_EQ(error.code, Code::kInvalidOption);
      EXPECT_EQ(error.option, second);
    }
  }
}

TEST(options, a_number_of_edges_of_holes_needs_the_word_holes) {
  for (const std::string_view repair : {"+holes", "holes", "seams,holes"})
    EXPECT_EQ(read_all({{"max_hole_edges", "64"}, {"repair", repair}}).core.max_hole_edges, 64u);
  for (const std::string_view repair : {"-holes", "none", "seams"}) {
    const Error error = error_of([&] { read_all({{"repair", repair}, {"max_hole_edges", "64"}}); });
    EXPECT_EQ(error.code, Code::kInvalidOption);
    EXPECT_EQ(error.option, "max_hole_edges");
  }
  EXPECT_EQ(read_all({{"max_hole_edges", "none"}}).core.max_hole_edges, std::nullopt);
}

TEST(options, all_that_are_declared_exist) {
  for (const OptionSpec& spec : option_table()) {
    SCOPED_TRACE(spec.name);
    OptionReader reader;
    if (spec.name == "max_hole_edges") reader.add("repair", "+holes");
    reader.add(spec.name, spec.example);
    EXPECT_NO_THROW(reader.check());
  }
  EXPECT_NO_THROW(OptionReader().check());
}

}  // namespace
}  // namespace remesh::api
