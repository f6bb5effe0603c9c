#include "api/options.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numeric>
#include <system_error>
#include <type_traits>
#include <utility>

#include "api/quoting.h"
#include "api/request_code.h"
#include "core/base/error.h"
#include "core/base/number_text.h"
#include "core/refinement/goals/goals.h"
#include "core/remesh.h"

namespace remesh::api {
namespace {

template <class T>
using Word = std::pair<std::string_view, bool T::*>;

constexpr std::array<Word<Repair>, 9> kRepairWords{{{"duplicates", &Repair::duplicates},
                                                    {"degenerate", &Repair::degenerate},
                                                    {"t_junctions", &Repair::t_junctions},
                                                    {"winding", &Repair::winding},
                                                    {"seams", &Repair::seams},
                                                    {"inside_out", &Repair::inside_out},
                                                    {"holes", &Repair::holes},
                                                    {"self_intersections", &Repair::self_intersections},
                                                    {"union", &Repair::make_union}}};
constexpr std::array<Word<Barriers>, 3> kBarrierWords{
    {{"object", &Barriers::object}, {"group", &Barriers::group}, {"material", &Barriers::material}}};

constexpr std::array<std::pair<std::string_view, Preset>, 2> kPresetWords{
    {{"volume", Preset::kVolume}, {"exact", Preset::kExact}}};

/// The value that a preset has for an option, as text.
struct PresetValue {
  Preset preset;
  std::string_view option;
  std::string_view text;
};
// See core/experiments.md, Preset for volume meshing. The bound on angles is the default, 25 degrees.
constexpr std::array<PresetValue, 5> kPresetValues{{
    {Preset::kVolume, "proximity", "0.25"},
    {Preset::kVolume, "elements_per_circle", "16"},
    {Preset::kExact, "feature_angle_deg", "0"},
    {Preset::kExact, "split_boundaries", "false"},
    {Preset::kExact, "defeature_size", "0"},
}};

/// The words for the values of an enumeration.
template <class Value>
struct Choice;
template <>
struct Choice<CircleFit> {
  static constexpr std::array<std::pair<std::string_view, CircleFit>, 2> kWords{
      {{"inscribed", CircleFit::kInscribed}, {"volume", CircleFit::kVolume}}};
};
template <>
struct Choice<LabelChoice> {
  static constexpr std::array<std::pair<std::string_view, LabelChoice>, 6> kWords{{{"auto", LabelChoice::kAuto},
                                                                                   {"object", LabelChoice::kObject},
                                                                                   {"group", LabelChoice::kGroup},
                                                                                   {"material", LabelChoice::kMaterial},
                                                                                   {"patch", LabelChoice::kPatch},
                                                                                   {"surface", LabelChoice::kSurface}}};
};
template <>
struct Choice<NameRule> {
  static constexpr std::array<std::pair<std::string_view, NameRule>, 2> kWords{
      {{"portable", NameRule::kPortable}, {"exact", NameRule::kExact}}};
};
template <>
struct Choice<StlSolids> {
  static constexpr std::array<std::pair<std::string_view, StlSolids>, 2> kWords{
      {{"label", StlSolids::kLabel}, {"one", StlSolids::kOne}}};
};
template <>
struct Choice<MshVersion> {
  static constexpr std::array<std::pair<std::string_view, MshVersion>, 2> kWords{
      {{"2.2", MshVersion::k22}, {"4.1", MshVersion::k41}}};
};

template <>
struct Choice<GlbColours> {
  static constexpr std::array<std::pair<std::string_view, GlbColours>, 2> kWords{
      {{"label", GlbColours::kLabel}, {"quality", GlbColours::kQuality}}};
};

/// The type of the member that a pointer points to, if an option's value may be only one of several words.
template <class Field>
struct ChoiceMember;
template <class Value, class Of>
struct ChoiceMember<Value Of::*> {
  using Type = Value;
};
template <class Field>
concept IsChoice = requires {
  Choice<typename ChoiceMember<Field>::Type>::kWords;
};

template <class Value>
auto& member_of(auto& options, Value Options::*field) {
  return options.core.*field;
}
template <class Value>
auto& member_of(auto& options, Value Writing::*field) {
  return options.writing.*field;
}

/// Sorts the rows by their groups.
template <std::size_t N>
std::array<OptionSpec, N> in_groups(std::array<OptionSpec, N> rows) {
  std::stable_sort(rows.begin(), rows.end(),
                   [](const OptionSpec& a, const OptionSpec& b) { return a.group < b.group; });
  return rows;
}

const std::array<OptionSpec, 36> kTable = in_groups<36>({{
    {.name = "refine",
     .type = OptionType::kBoolean,
     .field = &Options::refine,
     .group = OptionGroup::kResult,
     .help = "false: no points are inserted, and only the vertices that the shape needs are used",
     .example = "false"},
    {.name = "min_angle_deg",
     .type = OptionType::kNumber,
     .field = &Options::min_angle_deg,
     .group = OptionGroup::kResult,
     .help = "no angle is below this, except where the sharp corners of the input forbid it; 0: no bound",
     .unset = "auto",
     .excludes = "max_radius_edge_ratio",
     .example = "30"},
    {.name = "max_radius_edge_ratio",
     .type = OptionType::kNumber,
     .field = &Options::max_radius_edge_ratio,
     .group = OptionGroup::kExpert,
     .help = "in place of min_angle_deg: the largest ratio of circumradius to shortest edge, 1/(2 sin angle)",
     .unset = "none",
     .excludes = "min_angle_deg",
     .example = "1.2"},
    {.name = "target_faces",
     .type = OptionType::kInteger,
     .field = &Options::target_faces,
     .group = OptionGroup::kSize,
     .help = "about so many faces: the largest edge is chosen for it; what the other options need is made in any case",
     .unset = "none",
     .excludes = "target_edge_length",
     .example = "20000"},
    {.name = "target_edge_length",
     .type = OptionType::kNumber,
     .field = &Options::target_edge_length,
     .group = OptionGroup::kSize,
     .help = "the median edge is about this long, in model units: the largest edge is chosen for it",
     .unset = "none",
     .excludes = "target_faces",
     .example = "0.5"},
    {.name = "max_edge_length",
     .type = OptionType::kNumber,
     .field = &Options::max_edge_length,
     .group = OptionGroup::kSize,
     .help = "no edge is longer than this, in model units",
     .unset = "none",
     .excludes = "max_edge_fraction",
     .example = "0.5"},
    {.name = "max_edge_fraction",
     .type = OptionType::kNumber,
     .field = &Options::max_edge_fraction,
     .group = OptionGroup::kSize,
     .help = "in place of max_edge_length: the same length as a fraction of the bounding box's diagonal",
     .unset = "none",
     .excludes = "max_edge_length",
     .example = "0.02"},
    {.name = "max_area",
     .type = OptionType::kNumber,
     .field = &Options::max_area,
     .group = OptionGroup::kSize,
     .help = "no triangle is larger than this, in model units squared",
     .unset = "none",
     .example = "0.25"},
    {.name = "min_edge_length",
     .type = OptionType::kNumber,
     .field = &Options::min_edge_length,
     .group = OptionGroup::kSize,
     .help = "refinement makes no edge shorter than this, in model units; auto: such a length is chosen only if the "
             "faces would be out of proportion to the input; 0: edges of any length",
     .unset = "auto",
     .example = "0.001"},
    {.name = "defeature_size",
     .type = OptionType::kNumber,
     .field = &Options::defeature_size,
     .group = OptionGroup::kRepair,
     .help = "details smaller than this are removed, in model units; auto: only what the rounding of coordinates "
             "explains; 0: no details",
     .unset = "auto",
     .example = "0.01"},
    {.name = "proximity",
     .type = OptionType::kNumber,
     .field = &Options::proximity,
     .group = OptionGroup::kSize,
     .help = "edges to fit across the gap to the nearest facet that is not a neighbour, as in thin walls; 0: gaps do "
             "not matter",
     .example = "1"},
    {.name = "gradation",
     .type = OptionType::kNumber,
     .field = &Options::gradation,
     .group = OptionGroup::kSize,
     .help = "the largest factor by which neighbouring edges may differ in size; auto: 1.5 with proximity, otherwise "
             "no limit",
     .unset = "auto",
     .example = "1.3"},
    {.name = "max_output_faces",
     .type = OptionType::kInteger,
     .field = &Options::max_output_faces,
     .group = OptionGroup::kSize,
     .help = "the largest number of faces that the result may have: refinement stops there, and what certainly needs "
             "more is refused",
     .unset = "none",
     .example = "100000"},
    {.name = "split_boundaries",
     .type = OptionType::kBoolean,
     .field = &Options::split_boundaries,
     .group = OptionGroup::kExpert,
     .help = "false: the boundaries of patches get no new vertices",
     .example = "false"},
    {.name = "keep_boundary_vertices",
     .type = OptionType::kBoolean,
     .field = &Options::keep_boundary_vertices,
     .group = OptionGroup::kExpert,
     .help = "true: collinear vertices on the boundaries of patches stay",
     .example = "true"},
    {.name = "plane_tolerance",
     .type = OptionType::kNumber,
     .field = &Options::plane_tolerance,
     .group = OptionGroup::kExpert,
     .help = "the largest distance of a patch's vertices from its plane, in model units; auto: what the rounding of "
             "the coordinates explains",
     .unset = "auto",
     .example = "1e-5"},
    {.name = "feature_angle_deg",
     .type = OptionType::kNumber,
     .field = &Options::feature_angle_deg,
     .group = OptionGroup::kCurved,
     .help = "edges where facets turn by more than this are features and stay, and facets that turn by less may be one "
             "curved surface; 0: nothing is curved",
     .example = "40"},
    {.name = "surface_tolerance",
     .type = OptionType::kNumber,
     .field = &Options::surface_tolerance,
     .group = OptionGroup::kCurved,
     .help = "the largest distance between the curved parts of input and result, in model units; auto: as near as the "
             "input's own facets; 0: facets stay",
     .unset = "auto",
     .excludes = "surface_tolerance_fraction",
     .example = "0.01"},
    {.name = "surface_tolerance_fraction",
     .type = OptionType::kNumber,
     .field = &Options::surface_tolerance_fraction,
     .group = OptionGroup::kCurved,
     .help = "in place of surface_tolerance: the same distance as a fraction of the bounding box's diagonal",
     .unset = "none",
     .excludes = "surface_tolerance",
     .example = "0.001"},
    {.name = "elements_per_circle",
     .type = OptionType::kNumber,
     .field = ElementsField{},
     .group = OptionGroup::kCurved,
     .help = "the number of edges per full turn of a curved surface; 16 is usual before volume meshing; none: facets "
             "stay; auto: surfaces with more than 32 facets per turn get 24",
     .unset = "auto",
     .example = "16"},
    {.name = "circle_fit",
     .type = OptionType::kChoice,
     .field = &Options::circle_fit,
     .group = OptionGroup::kCurved,
     .help = "where vertices of remeshed curved surfaces lie; inscribed: on the surface; volume: a little outside, so "
             "that the volume of the solid is kept",
     .example = "volume"},
    {.name = "normal_tolerance",
     .type = OptionType::kNumber,
     .field = &Options::normal_tolerance,
     .group = OptionGroup::kExpert,
     .help = "unit normals in one patch may always differ by this much in each component",
     .example = "1e-5"},
    {.name = "weld_tolerance",
     .type = OptionType::kNumber,
     .field = &Options::weld_tolerance,
     .group = OptionGroup::kRepair,
     .help = "vertices at most this far apart are merged, in model units; 0: only those with equal coordinates",
     .example = "1e-6"},
    {.name = "repair",
     .type = OptionType::kWords,
     .field = &Options::repair,
     .group = OptionGroup::kRepair,
     .help = "the defects of the input that are repaired; a list of words replaces the default, and +word or -word "
             "changes it",
     .example = "duplicates,degenerate"},
    {.name = "max_hole_edges",
     .type = OptionType::kInteger,
     .field = &Options::max_hole_edges,
     .group = OptionGroup::kRepair,
     .help = "with holes in repair: flat holes whose rims have at most this many edges are closed; none: small holes",
     .unset = "none",
     .example = "64"},
    {.name = "barriers",
     .type = OptionType::kWords,
     .field = &Options::barriers,
     .group = OptionGroup::kExpert,
     .help = "the labels that separate patches even in one plane; a list of words replaces the default, and +word or "
             "-word changes it",
     .example = "none"},
    {.name = "local_origin",
     .type = OptionType::kBoolean,
     .field = &Options::local_origin,
     .group = OptionGroup::kResult,
     .help = "true: coordinates that the format cannot hold are written relative to an origin near the mesh, which the "
             "report gives",
     .example = "true"},
    {.name = "reference_axis",
     .type = OptionType::kAxis,
     .field = AxisField{},
     .group = OptionGroup::kExpert,
     .help = "the direction of the first axis in the plane of each patch: x, dominant_edge, or a direction dx,dy,dz",
     .example = "0,1,0"},
    {.name = "preset",
     .type = OptionType::kChoice,
     .field = PresetField{},
     .group = OptionGroup::kResult,
     .help = "values for several options, where these are not given; volume: what suits volume meshing "
             "(proximity=0.25, elements_per_circle=16); exact: facets and boundaries stay (feature_angle_deg=0, "
             "split_boundaries=false, defeature_size=0)",
     .unset = "none",
     .example = "exact"},
    {.name = "format",
     .type = OptionType::kChoice,
     .field = FormatField{},
     .group = OptionGroup::kResult,
     .help = "the format of the result; auto: what the Accept header or the name of the file asks for, otherwise the "
             "format of the input",
     .unset = "auto",
     .example = "json"},
    {.name = "label",
     .type = OptionType::kChoice,
     .field = &Writing::label,
     .group = OptionGroup::kResult,
     .help =
         "the labels that name the boundaries in formats with one label for each face (stl_ascii, msh, mesh, smesh, "
         "glb); auto: groups, otherwise objects, otherwise materials, otherwise patches",
     .example = "material"},
    {.name = "names",
     .type = OptionType::kChoice,
     .field = &Writing::names,
     .group = OptionGroup::kResult,
     .help =
         "the names of boundaries in stl_ascii, msh, mesh and smesh; portable: ASCII letters, digits, _, - and ., at "
         "most 120 bytes, no two equal, which all mesh programs read; exact: as they came",
     .example = "exact"},
    {.name = "stl_solids",
     .type = OptionType::kChoice,
     .field = &Writing::stl_solids,
     .group = OptionGroup::kResult,
     .help = "the solids of stl_ascii; label: one for each boundary; one: a single one without a name, because some "
             "programs read only the first solid",
     .example = "one"},
    {.name = "msh_version",
     .type = OptionType::kChoice,
     .field = &Writing::msh_version,
     .group = OptionGroup::kResult,
     .help = "the version of Gmsh's format in which msh is written",
     .example = "4.1"},
    {.name = "ply_labels",
     .type = OptionType::kNames,
     .field = PlyLabelsField{},
     .group = OptionGroup::kExpert,
     .help = "the properties of faces in a PLY file of which the first one that it has is read as groups; auto: group, "
             "group_id, layer_id, material_index; none: no groups",
     .unset = "auto",
     .example = "part_id,zone"},
    {.name = "glb_colours",
     .type = OptionType::kChoice,
     .field = &Writing::glb_colours,
     .group = OptionGroup::kResult,
     .help =
         "the colours in glb; label: one for each boundary, see label; quality: one for each 5 degrees of the smallest "
         "angle of a triangle, from red to green",
     .example = "quality"},
}});

[[noreturn]] void fail(const OptionSpec& spec, const std::string& message) {
  throw Error(Code::kInvalidOption, Stage::kRead, std::string(spec.name) + " " + message)
      .for_option(std::string(spec.name));
}

std::string describe_words(const OptionSpec& spec) {
  std::string text;
  for (const std::string_view word : option_words(spec)) text.append(text.empty() ? "" : ", ").append(word);
  return text;
}

[[noreturn]] void fail_value(const OptionSpec& spec, std::string_view text) {
  std::string expected;
  switch (spec.type) {
    case OptionType::kBoolean: expected = "true or false"; break;
    case OptionType::kNumber: expected = "a number " + number_range(spec.name)->text(); break;
    case OptionType::kInteger: expected = "a whole number " + number_range(spec.name)->text(); break;
    case OptionType::kWords:
      expected = "none, or some of " + describe_words(spec) +
                 ", each once, separated by commas: all without a sign, or all as +word or -word";
      break;
    case OptionType::kAxis: expected = "x, dominant_edge, or three numbers dx,dy,dz that are not all 0"; break;
    case OptionType::kNames: expected = "none, or names separated by commas, each of 1 to 100 bytes"; break;
    case OptionType::kChoice:
      expected = (option_words(spec).size() == 1 ? "" : "one of ") + describe_words(spec);
      break;
  }
  if (spec.type == OptionType::kNumber)
    for (const std::string_view word : option_words(spec)) expected.append(", ").append(word);
  if (!spec.unset.empty()) expected += ", or " + std::string(spec.unset);
  fail(spec, "must be " + expected + ", not " + in_quotes(text));
}

std::optional<double> parse_finite(std::string_view text) {
  const Real real = parse_real(text);
  return real.fault == RealFault::kNone ? std::optional(real.value) : std::nullopt;
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t end = text.find(separator);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

/// Reads a boolean as programming languages write it: `true`, `True`, `TRUE` or `1`.
bool parse_boolean(const OptionSpec& spec, std::string_view text) {
  const std::string word = ascii_lower(text);
  if (word == "true" || word == "1") return true;
  if (word != "false" && word != "0") fail_value(spec, text);
  return false;
}

void check_range(const OptionSpec& spec, double value, std::string_view text) {
  if (!number_range(spec.name)->contains(value)) fail_value(spec, text);
}

double parse_number(const OptionSpec& spec, std::string_view text) {
  const std::optional<double> value = parse_finite(text);
  if (!value) fail_value(spec, text);
  check_range(spec, *value, text);
  return *value;
}

/// Reads an integer. "1e6" and "1000.0" are accepted too: they are integers in JSON Schema and to callers who compute
/// in doubles.
std::uint64_t parse_integer(const OptionSpec& spec, std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) {
    const std::optional<double> number = parse_finite(text);
    if (!number || !(*number >= 0 && *number <= 0x1p53) || *number != std::floor(*number)) fail_value(spec, text);
    value = static_cast<std::uint64_t>(*number);
  }
  check_range(spec, static_cast<double>(value), text);
  return value;
}

/// The sign in front of a word of a list. `application/x-www-form-urlencoded` decodes a plus to a blank, so a plus
/// that was typed in a URL may arrive as a blank.
enum class WordSign { kNone, kPlus, kMinus };

WordSign take_sign(std::string_view& word) {
  WordSign sign = WordSign::kNone;
  if (word.starts_with('+') || word.starts_with(' ')) sign = WordSign::kPlus;
  if (word.starts_with('-')) sign = WordSign::kMinus;
  if (sign != WordSign::kNone) word.remove_prefix(1);
  return sign;
}

/// Reads a list of words. Words without signs are the whole list; words with signs change the default.
template <class T, std::size_t N>
T parse_words(const OptionSpec& spec, const std::array<Word<T>, N>& words, std::string_view text) {
  T none, given;
  for (const auto& [name, member] : words) none.*member = given.*member = false;
  if (text == "none") return none;
  const std::vector<std::string_view> parts = split(text, ',');
  std::string_view first = parts.front();
  const bool are_changes = take_sign(first) != WordSign::kNone;
  T set = are_changes ? T{} : none;
  for (std::string_view part : parts) {
    const WordSign sign = take_sign(part);
    const auto word = std::find_if(words.begin(), words.end(), [&](const auto& w) { return w.first == part; });
    if (word == words.end() || given.*(word->second)) fail_value(spec, text);
    if ((sign != WordSign::kNone) != are_changes)
      fail(spec, "mixes words with a sign, which change the default, and words without a sign, which replace it: " +
                     in_quotes(text) + "; a blank before a word counts as a plus");
    given.*(word->second) = true;
    set.*(word->second) = sign != WordSign::kMinus;
  }
  return set;
}

template <class T, std::size_t N>
std::string words_text(const std::array<Word<T>, N>& words, const T& set) {
  std::string text;
  for (const auto& [name, member] : words) {
    if (set.*member) text.append(text.empty() ? "" : ",").append(name);
  }
  return text.empty() ? "none" : text;
}

/// The value of elements_per_circle with which facets stay.
constexpr std::string_view kNoElements = "none";

void parse_elements(const OptionSpec& spec, std::string_view text, Options& options) {
  const bool is_word = text == kNoElements || text == spec.unset;
  options.elements_per_circle = is_word ? std::nullopt : std::optional(parse_number(spec, text));
  options.coarsens_fine_facets = text != kNoElements;
}

void parse_axis(const OptionSpec& spec, std::string_view text, Options& options) {
  if (text == "x" || text == "dominant_edge") {
    options.reference_axis = text == "x" ? ReferenceAxis::kX : ReferenceAxis::kDominantEdge;
    return;
  }
  const std::vector<std::string_view> parts = split(text, ',');
  if (parts.size() != 3) fail_value(spec, text);
  Vec3 direction;
  for (int axis = 0; axis < 3; ++axis) {
    const std::optional<double> value = parse_finite(parts[static_cast<std::size_t>(axis)]);
    if (!value) fail_value(spec, text);
    direction[axis] = *value;
  }
  if (direction == Vec3{}) fail_value(spec, text);
  options.reference_axis = ReferenceAxis::kGiven;
  options.reference_direction = direction;
}

/// The word for no names.
constexpr std::string_view kNoNames = "none";

std::vector<std::string> parse_names(const OptionSpec& spec, std::string_view text) {
  constexpr std::size_t kMaxNames = 100, kMaxName = 100;
  std::vector<std::string> names;
  if (text == kNoNames) return names;
  for (const std::string_view name : split(text, ',')) {
    if (name.empty() || name.size() > kMaxName || names.size() == kMaxNames) fail_value(spec, text);
    names.emplace_back(name);
  }
  return names;
}

std::string names_text(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text.append(text.empty() ? "" : ",").append(name);
  return text.empty() ? std::string(kNoNames) : text;
}

std::string axis_text(const Options& options) {
  switch (options.reference_axis) {
    case ReferenceAxis::kX: return "x";
    case ReferenceAxis::kDominantEdge: return "dominant_edge";
    case ReferenceAxis::kGiven: break;
  }
  const Vec3& d = options.reference_direction;
  return shortest_text(d.x) + "," + shortest_text(d.y) + "," + shortest_text(d.z);
}

/// Finds the value that a word stands for.
template <class Value, std::size_t N>
Value parse_choice(const OptionSpec& spec, const std::array<std::pair<std::string_view, Value>, N>& words,
                   std::string_view text) {
  const auto* word = std::find_if(words.begin(), words.end(), [&](const auto& w) { return w.first == text; });
  if (word == words.end()) fail_value(spec, text);
  return word->second;
}

template <class Value, std::size_t N>
std::string_view choice_name(const std::array<std::pair<std::string_view, Value>, N>& words, Value value) {
  const auto* word = std::find_if(words.begin(), words.end(), [&](const auto& w) { return w.second == value; });
  return word == words.end() ? std::string_view() : word->first;
}

Format parse_format(const OptionSpec& spec, std::string_view text) {
  const std::optional<Format> format = format_from_name(text);
  if (!format || !is_written(*format)) fail_value(spec, text);
  return *format;
}

void set_value(const OptionSpec& spec, std::string_view text, RequestOptions& options) {
  Options& core = options.core;
  std::visit(
      [&](auto field) {
        using F = decltype(field);
        if constexpr (std::is_same_v<F, bool Options::*>) {
          core.*field = parse_boolean(spec, text);
        } else if constexpr (std::is_same_v<F, double Options::*>) {
          core.*field = parse_number(spec, text);
        } else if constexpr (std::is_same_v<F, std::optional<double> Options::*>) {
          core.*field = text == spec.unset ? std::nullopt : std::optional(parse_number(spec, text));
        } else if constexpr (std::is_same_v<F, std::optional<std::uint64_t> Options::*>) {
          core.*field = text == spec.unset ? std::nullopt : std::optional(parse_integer(spec, text));
        } else if constexpr (std::is_same_v<F, Repair Options::*>) {
          core.*field = parse_words(spec, kRepairWords, text);
        } else if constexpr (std::is_same_v<F, Barriers Options::*>) {
          core.*field = parse_words(spec, kBarrierWords, text);
        } else if constexpr (IsChoice<F>) {
          member_of(options, field) = parse_choice(spec, Choice<typename ChoiceMember<F>::Type>::kWords, text);
        } else if constexpr (std::is_same_v<F, AxisField>) {
          parse_axis(spec, text, core);
        } else if constexpr (std::is_same_v<F, ElementsField>) {
          parse_elements(spec, text, core);
        } else if constexpr (std::is_same_v<F, PlyLabelsField>) {
          options.ply_labels = text == spec.unset ? std::nullopt : std::optional(parse_names(spec, text));
        } else if constexpr (std::is_same_v<F, PresetField>) {
          options.preset = text == spec.unset ? std::nullopt : std::optional(parse_choice(spec, kPresetWords, text));
        } else {
          options.format = text == spec.unset ? std::nullopt : std::optional(parse_format(spec, text));
        }
      },
      spec.field);
}

bool is_word_of(const OptionSpec& spec, std::string_view text) {
  const std::vector<std::string_view> words = option_words(spec);
  return std::find(words.begin(), words.end(), text) != words.end();
}

// JSON has types, so a string is not accepted as a number. An option that may be unset accepts null or its word.
void check_kind(const OptionSpec& spec, std::string_view text, ValueKind kind) {
  bool fits = true;
  switch (kind) {
    case ValueKind::kUntyped: break;
    case ValueKind::kBoolean: fits = spec.type == OptionType::kBoolean; break;
    case ValueKind::kNumber:
      fits = spec.type == OptionType::kNumber || spec.type == OptionType::kInteger || is_word_of(spec, text);
      break;
    case ValueKind::kList:
      fits = spec.type == OptionType::kWords || spec.type == OptionType::kAxis || spec.type == OptionType::kNames;
      break;
    case ValueKind::kNull: fits = !spec.unset.empty(); break;
    case ValueKind::kObject: fits = false; break;
    case ValueKind::kString:
      fits = (!spec.unset.empty() && text == spec.unset) || spec.type == OptionType::kWords ||
             spec.type == OptionType::kAxis || spec.type == OptionType::kChoice || spec.type == OptionType::kNames ||
             is_word_of(spec, text);
      break;
  }
  if (!fits) fail_value(spec, kind == ValueKind::kNull ? "null" : text);
}

bool is_set(const OptionSpec& spec, const RequestOptions& options) {
  return !std::holds_alternative<std::monostate>(option_value(spec, options));
}

/// Names that other programs have for options of ours.
constexpr std::array<std::pair<std::string_view, std::string_view>, 12> kOtherNames{{{"hmax", "max_edge_length"},
                                                                                     {"hsiz", "max_edge_length"},
                                                                                     {"clmax", "max_edge_length"},
                                                                                     {"lcmax", "max_edge_length"},
                                                                                     {"size", "max_edge_length"},
                                                                                     {"hmin", "min_edge_length"},
                                                                                     {"clmin", "min_edge_length"},
                                                                                     {"hgrad", "gradation"},
                                                                                     {"hausd", "surface_tolerance"},
                                                                                     {"clcurv", "elements_per_circle"},
                                                                                     {"output", "format"},
                                                                                     {"type", "format"}}};

/// Writes a name in lower case and without separators, so that maxEdgeLength is max_edge_length.
std::string plain_name(std::string_view name) {
  std::string plain;
  for (const char c : ascii_lower(name))
    if (c != '_' && c != '-' && c != ' ' && c != '.') plain += c;
  return plain;
}

// Computes the Levenshtein distance row by row.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = std::exchange(row[j], std::min({replaced, row[j] + 1, row[j - 1] + 1}));
    }
  }
  return row.back();
}

}  // namespace

std::span<const OptionSpec> option_table() { return kTable; }

std::string_view group_name(OptionGroup group) {
  switch (group) {
    case OptionGroup::kResult: return "result";
    case OptionGroup::kSize: return "size";
    case OptionGroup::kCurved: return "curved";
    case OptionGroup::kRepair: return "repair";
    case OptionGroup::kExpert: break;
  }
  return "expert";
}

const OptionSpec* find_option(std::string_view name) {
  const auto spec = std::find_if(kTable.begin(), kTable.end(), [&](const OptionSpec& s) { return s.name == name; });
  return spec == kTable.end() ? nullptr : &*spec;
}

const OptionSpec& nearest_option(std::string_view name) {
  constexpr std::size_t kLongestCompared = 64;  // the caller chooses the length of the name
  const std::string_view start = name.substr(0, kLongestCompared);
  const std::string plain = plain_name(start);
  const auto* other =
      std::find_if(kOtherNames.begin(), kOtherNames.end(), [&](const auto& n) { return n.first == plain; });
  if (other != kOtherNames.end()) return *find_option(other->second);
  // A part of a name is nearer to it than another name of the same length: max_edge stands for max_edge_length.
  constexpr std::size_t kShortestPart = 4, kPerEdit = 4;
  const auto distance = [&](const OptionSpec& spec) {
    const std::string full = plain_name(spec.name);
    const auto& [part, whole] =
        std::minmax(plain, full, [](const auto& a, const auto& b) { return a.size() < b.size(); });
    if (part.size() >= kShortestPart && whole.find(part) != std::string::npos) return whole.size() - part.size();
    return kPerEdit * edit_distance(plain, full);
  };
  return *std::min_element(kTable.begin(), kTable.end(),
                           [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
}

bool is_of_output(const OptionSpec& spec) {
  return std::visit(
      [&](auto field) {
        using F = decltype(field);
        if constexpr (std::is_same_v<F, bool Options::*>) return field == &Options::local_origin;
        if constexpr (IsChoice<F>) return !std::is_same_v<F, CircleFit Options::*>;
        return std::is_same_v<F, FormatField>;
      },
      spec.field);
}

std::vector<std::string_view> option_words(const OptionSpec& spec) {
  std::vector<std::string_view> words;
  if (std::holds_alternative<Repair Options::*>(spec.field)) {
    for (const auto& word : kRepairWords) words.push_back(word.first);
  } else if (std::holds_alternative<Barriers Options::*>(spec.field)) {
    for (const auto& word : kBarrierWords) words.push_back(word.first);
  } else if (std::holds_alternative<ElementsField>(spec.field)) {
    words.push_back(kNoElements);
  } else if (std::holds_alternative<PresetField>(spec.field)) {
    for (const auto& word : kPresetWords) words.push_back(word.first);
  } else if (std::holds_alternative<FormatField>(spec.field)) {
    for (const Format format : kFormats)
      if (is_written(format)) words.push_back(format_name(format));
  }
  std::visit(
      [&](auto field) {
        if constexpr (IsChoice<decltype(field)>)
          for (const auto& word : Choice<typename ChoiceMember<decltype(field)>::Type>::kWords)
            words.push_back(word.first);
      },
      spec.field);
  return words;
}

OptionValue option_value(const OptionSpec& spec, const RequestOptions& options) {
  const Options& core = options.core;
  return std::visit(
      [&](auto field) -> OptionValue {
        using F = decltype(field);
        if constexpr (std::is_same_v<F, bool Options::*> || std::is_same_v<F, double Options::*>) {
          return core.*field;
        } else if constexpr (std::is_same_v<F, std::optional<double> Options::*> ||
                             std::is_same_v<F, std::optional<std::uint64_t> Options::*>) {
          return core.*field ? OptionValue(*(core.*field)) : OptionValue();
        } else if constexpr (std::is_same_v<F, Repair Options::*>) {
          return words_text(kRepairWords, core.*field);
        } else if constexpr (std::is_same_v<F, Barriers Options::*>) {
          return words_text(kBarrierWords, core.*field);
        } else if constexpr (IsChoice<F>) {
          return std::string(choice_name(Choice<typename ChoiceMember<F>::Type>::kWords, member_of(options, field)));
        } else if constexpr (std::is_same_v<F, AxisField>) {
          return axis_text(core);
        } else if constexpr (std::is_same_v<F, ElementsField>) {
          if (core.elements_per_circle) return *core.elements_per_circle;
          return core.coarsens_fine_facets ? OptionValue() : OptionValue(std::string(kNoElements));
        } else if constexpr (std::is_same_v<F, PlyLabelsField>) {
          return options.ply_labels ? OptionValue(names_text(*options.ply_labels)) : OptionValue();
        } else if constexpr (std::is_same_v<F, PresetField>) {
          return options.preset ? OptionValue(std::string(choice_name(kPresetWords, *options.preset))) : OptionValue();
        } else {
          return options.format ? OptionValue(std::string(format_name(*options.format))) : OptionValue();
        }
      },
      spec.field);
}

std::string option_text(const OptionSpec& spec, const RequestOptions& options) {
  return std::visit(
      [&](const auto& value) -> std::string {
        using V = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<V, std::monostate>) {
          return std::string(spec.unset);
        } else if constexpr (std::is_same_v<V, bool>) {
          return value ? "true" : "false";
        } else if constexpr (std::is_same_v<V, std::string>) {
          return value;
        } else if constexpr (std::is_floating_point_v<V>) {
          return shortest_text(value);
        } else {
          return std::to_string(value);
        }
      },
      option_value(spec, options));
}

RequestOptions with_defaults(RequestOptions options) {
  Options& core = options.core;
  core.coarsens_fine_facets = are_fine_facets_coarsened(core);
  if (!core.refine) return options;
  const Goals goals = goals_of(core, /*diagonal=*/1);
  if (!core.max_radius_edge_ratio) core.min_angle_deg = goals.min_angle_deg;
  if (goals.gradation > 0) core.gradation = goals.gradation;
  return options;
}

void OptionReader::add(std::string_view name, std::string_view text, ValueKind kind) {
  const OptionSpec* spec = find_option(name);
  if (spec == nullptr) {
    const std::string_view nearest = nearest_option(name).name;
    throw Error(as_code(RequestCode::kUnknownOption), Stage::kRead,
                "there is no option " + in_quotes(name) + "; the nearest is \"" + std::string(nearest) + "\"")
        .for_option(shortened(name));
  }
  if (is_given(name)) fail(*spec, "is given twice");
  if (kind == ValueKind::kUntyped && text.empty()) fail(*spec, "is empty: give it a value, or leave it out");
  check_kind(*spec, text, kind);
  set_value(*spec, kind == ValueKind::kNull ? spec->unset : text, options_);
  given_.push_back(spec->name);
  if (std::holds_alternative<PresetField>(spec->field)) apply_preset();
  const OptionSpec* other = find_option(spec->excludes);
  if (other != nullptr && is_set(*spec, options_) && is_set(*other, options_)) {
    fail(*spec, "and " + std::string(other->name) + " exclude each other");
  }
}

void OptionReader::apply_preset() {
  for (const PresetValue& value : kPresetValues) {
    if (value.preset == options_.preset && !is_given(value.option))
      set_value(*find_option(value.option), value.text, options_);
  }
}

void OptionReader::check() const { check_options(options_.core); }

bool OptionReader::is_given(std::string_view name) const {
  return std::find(given_.begin(), given_.end(), name) != given_.end();
}

}  // namespace remesh::api
