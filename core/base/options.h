/// The options and settings of the pipeline. The contract defines their names and meanings.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "core/base/vec.h"

namespace remesh {

/// The direction of a patch's x axis in its plane (rules.md, Patch frames).
enum class ReferenceAxis { kX, kDominantEdge, kGiven };

/// The defects that are mended before the pipeline begins. The report counts each mending.
struct Repair {
  bool duplicates = true;
  bool degenerate = true;
  bool t_junctions = true;
  bool winding = true;
  bool seams = true;
  bool inside_out = false;
  bool holes = false;
  bool self_intersections = false;
  bool make_union = false;  ///< includes self_intersections
  friend bool operator==(const Repair&, const Repair&) = default;
};

/// The places of vertices of curved surfaces.
enum class CircleFit {
  kInscribed,  ///< vertices lie on the surfaces
  kVolume,     ///< vertices lie outside, so that the volume of what they bound is kept, or the area of an open surface
};

/// The kinds of labels that separate patches within a plane.
struct Barriers {
  bool object = true;
  bool group = true;
  bool material = true;
  friend bool operator==(const Barriers&, const Barriers&) = default;
};

/// The options of a run. Lengths are in model units, angles in degrees. If an optional is empty, the contract's default
/// applies. The ranges of the numbers stand in `number_options`.
/// This class is larger than the bound because it has one member for each option of the contract.
struct Options {
  static constexpr double kMaxMinAngleDeg = 33;

  bool refine = true;
  std::optional<double> min_angle_deg;
  std::optional<double> max_radius_edge_ratio;  ///< instead of min_angle_deg
  std::optional<double> max_edge_length;
  std::optional<double> max_edge_fraction;  ///< instead of max_edge_length; a fraction of the bounding box's diagonal
  std::optional<double> max_area;
  /// The largest edge is chosen so that the result has about so many faces.
  std::optional<std::uint64_t> target_faces;
  std::optional<double> target_edge_length;  ///< the same, so that the median edge is about this long
  /// Empty: refinement makes edges of any length, as long as there are not far more faces than in the input; see
  /// goals.h. 0: of any length, whatever the number of faces.
  std::optional<double> min_edge_length;
  double proximity = 0;  ///< 0: off
  std::optional<double> gradation;
  std::optional<std::uint64_t> max_output_faces;
  bool split_boundaries = true;
  bool keep_boundary_vertices = false;
  std::optional<double> plane_tolerance;  ///< empty: computed from the input's rounding noise
  /// Details smaller than this are removed, in model units: short edges, narrow faces, low steps and flaps, narrow
  /// slits. Empty: details that are smaller than the plane tolerance, except slits. 0: none.
  std::optional<double> defeature_size;
  double normal_tolerance = 1e-6;  ///< per component of the unit normal
  /// Edges between facets that turn by more than this are features. Facets that meet at a smaller angle may be pieces
  /// of one curved surface. 0: each facet is its own surface.
  double feature_angle_deg = 30;
  /// Max distance between curved parts of the input and of the output, in model units. 0: facets stay as they are.
  /// Empty: where a number of elements per circle applies, the distance of the input's own facets from each surface;
  /// elsewhere facets stay.
  std::optional<double> surface_tolerance;
  std::optional<double> surface_tolerance_fraction;  ///< instead of surface_tolerance; a fraction of the diagonal
  /// Edges per full turn on curved surfaces. Empty: see coarsens_fine_facets.
  std::optional<double> elements_per_circle;
  /// If no option gives a resolution for curved surfaces, surfaces with many facets per turn are remeshed with fewer
  /// (elements_per_circle=auto); false: facets stay (elements_per_circle=none). See are_fine_facets_coarsened.
  bool coarsens_fine_facets = true;
  CircleFit circle_fit = CircleFit::kInscribed;
  double weld_tolerance = 0;  ///< 0: only equal coordinates are one vertex
  Repair repair;
  /// Holes whose rims have at most so many edges are closed, if `repair` has `holes`. Empty: those smaller than
  /// defeature_size, or without such a size those that are small by themselves (core/mending/edges/holes.h).
  std::optional<std::uint64_t> max_hole_edges;
  Barriers barriers;
  /// If the output format cannot hold the result otherwise, write it relative to an origin near the mesh.
  bool local_origin = false;
  ReferenceAxis reference_axis = ReferenceAxis::kDominantEdge;
  Vec3 reference_direction;  ///< used with ReferenceAxis::kGiven; any length but 0
};

/// The values that an option may have if it is a number.
struct NumberRange {
  double minimum = 0;
  bool above_minimum = false;          ///< the minimum itself is excluded
  std::optional<double> maximum = {};  ///< it is included

  /// False for infinity and NaN, too.
  bool contains(double value) const;
  /// The range in words that follow "a number": `from 0 to 33`, `above 0`, `of at least 1`.
  std::string text() const;
};

/// An option that is a number.
struct NumberOption {
  std::string_view name;
  std::variant<double Options::*, std::optional<double> Options::*, std::optional<std::uint64_t> Options::*> member;
  NumberRange range;
};

/// All options that are numbers. Their ranges are declared here and nowhere else: `check_options`, the readers of the
/// API, /v1/capabilities and the page take them from here, and tests hold the documents against them.
std::span<const NumberOption> number_options();
/// Output: null if no option of that name is a number.
const NumberRange* number_range(std::string_view name);

/// Returns whether the largest edge is chosen so that a target is met.
bool is_target_given(const Options& options);
/// Returns whether a number of elements per circle or a tolerance is given for curved surfaces.
bool is_curved_resolution_given(const Options& options);
/// Returns whether elements_per_circle=auto acts: neither a number of elements nor a tolerance is given, and boundaries
/// may be cut anew.
bool are_fine_facets_coarsened(const Options& options);

/// Errors: Code::kInvalidOption - a value is out of its range, or two options exclude each other (`option` is set).
void check_options(const Options& options);

/// Checks the options that depend on the input: lengths given as a fraction of its bounding box's diagonal.
/// Errors: as above.
void check_options(const Options& options, double diagonal);

/// The numbers in which an output format stores coordinates.
enum class Storage {
  kDouble,  ///< all doubles, bit for bit
  kFloat,   ///< floats of 32 bits
};

/// The treatment of a result's coordinates for a storage format.
enum class OutputRounding : std::uint8_t {
  kRequired,  ///< they are rounded; a result that the storage cannot hold is refused
  kIfHeld,    ///< as kRequired, but a result that the storage cannot hold keeps its doubles, and a diagnostic says so
  kLater,     ///< they stay doubles for now
};

/// The settings with which a run is carried out. Only `storage` and `rounding` change bytes of the result.
struct RunSettings {
  int workers = 1;  ///< number of threads that compute, at least 1
  /// Fill Result::face_source and input_face_patch. This costs a point location per face.
  bool want_face_source = false;
  /// Without refinement, the work grows with the input alone. Then one thread computes an input with fewer corners than
  /// this.
  std::size_t serial_corners = 0;
  /// The numbers in which the result will be stored. Refinement makes no edge whose ends would become equal in them.
  /// The result is rounded to them, and then checked, measured and reported.
  Storage storage = Storage::kDouble;
  OutputRounding rounding = OutputRounding::kRequired;
  /// Is called with one line for each attempt: what has failed, and what was decided. It may be empty.
  std::function<void(const std::string&)> trace = {};
};

}  // namespace remesh
