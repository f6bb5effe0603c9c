/// What a caller may ask of the pipeline; names and meanings are the contract's.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "core/base/vec.h"

namespace remesh {

/// Where the in-plane x axis of a patch points (rules.md, Patch frames).
enum class ReferenceAxis { kX, kDominantEdge, kGiven };

/// What is mended on the way in; each mending is counted in the report.
struct Repair {
  bool duplicates = true;
  bool degenerate = true;
  bool t_junctions = true;
  bool winding = true;
  bool seams = true;
  bool inside_out = false;
  friend bool operator==(const Repair&, const Repair&) = default;
};

/// Which labels bound patches inside a plane.
struct Barriers {
  bool object = true;
  bool group = true;
  bool material = true;
  friend bool operator==(const Barriers&, const Barriers&) = default;
};

/// Lengths are in model units, angles in degrees. An empty optional means: the default of the contract.
struct Options {
  static constexpr double kMaxMinAngleDeg = 33;
  static constexpr double kMinRadiusEdgeRatio = 0.918;  ///< 1 / (2 sin 33 degrees), cut after three decimals
  static constexpr double kMaxNormalTolerance = 0.5;

  bool refine = true;
  std::optional<double> min_angle_deg;          ///< 0 to kMaxMinAngleDeg
  std::optional<double> max_radius_edge_ratio;  ///< instead of min_angle_deg
  std::optional<double> max_edge_length;        ///< > 0
  std::optional<double> max_edge_fraction;      ///< instead of max_edge_length; of the bounding box's diagonal
  std::optional<double> max_area;               ///< > 0
  std::optional<double> min_edge_length;        ///< > 0
  double proximity = 0;                         ///< 0: off
  std::optional<double> gradation;              ///< > 1
  std::optional<std::uint64_t> max_output_faces;
  bool split_boundaries = true;
  bool keep_boundary_vertices = false;
  std::optional<double> plane_tolerance;  ///< > 0; empty: from the input's rounding noise
  double normal_tolerance = 1e-6;         ///< per component of the unit normal, 0 to kMaxNormalTolerance
  double weld_tolerance = 0;              ///< 0: only equal coordinates are one vertex
  Repair repair;
  Barriers barriers;
  bool local_origin = false;  ///< write about an origin near the part what the output format cannot hold otherwise
  ReferenceAxis reference_axis = ReferenceAxis::kDominantEdge;
  Vec3 reference_direction;  ///< used with ReferenceAxis::kGiven; any length but 0
};

/// Errors: Code::kInvalidOption - a value out of its range, or two options that exclude each other (`option` is set).
void check_options(const Options& options);

/// The same for what only the input tells: lengths given as a part of its bounding box's diagonal.
void check_options(const Options& options, double diagonal);

/// The numbers in which an output format stores coordinates.
enum class Storage {
  kDouble,  ///< all doubles, bit for bit
  kFloat,   ///< floats of 32 bits
};

/// How a run is carried out; nothing here but `storage` changes a byte of the result.
struct RunSettings {
  int workers = 1;                ///< threads that compute, at least 1
  bool want_face_source = false;  ///< fill Result::face_source and input_face_patch (costs a point location a face)
  /// Where the work grows with the input alone (nothing is refined), one thread takes an input of fewer corners.
  std::size_t serial_corners = 0;
  /// The result is rounded to these numbers, and is checked, measured and reported as they have it.
  Storage storage = Storage::kDouble;
};

}  // namespace remesh
