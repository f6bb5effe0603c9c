#include "api/options.h"

#include <algorithm>
#include <array>

namespace remesh::api {
namespace {

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
     .help = "the largest distance between the curved parts of input and result, in model units; above 0, surfaces of "
             "no kind become coarser as well; auto: as near as the input's own facets; 0: facets stay",
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
     .help =
         "the format of the result; auto: what the Accept header or the name of the output file asks for, otherwise "
         "the format of the input",
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

}  // namespace remesh::api
