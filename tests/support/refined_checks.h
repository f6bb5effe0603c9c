/// Measurements on a refined surface that do not trust its report.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "core/base/options.h"
#include "core/mesh/mesh.h"
#include "core/remesh.h"

namespace remesh {

Result refined(const PolygonMesh& mesh, const Options& options = {}, int workers = 2);
/// Returns how many faces an analysis expects of a remeshing with these options.
double predicted_faces(const PolygonMesh& mesh, const Options& options, int workers = 2);
Options with_angle(double degrees);
Options with_length(double length);

struct Bounds {
  double min_angle_deg = 0;
  double max_edge_length = std::numeric_limits<double>::infinity();
  double max_area = std::numeric_limits<double>::infinity();
};

/// Returns the bounds that options ask for. Lengths given as a fraction are left to the caller.
Bounds bounds_of(const Options& options);

/// True if gaps or short edges ask for sizes of their own. Faces that meet all of Bounds may then be listed.
bool do_sizes_vary(const Options& options);

/// Returns the faces that miss a bound.
/// Input: `slack` - the bounds are made wider by this share, or tighter if it is negative.
std::vector<FaceId> faces_beyond(const TriangleMesh& mesh, const Bounds& bounds, double slack = 0);

double smallest_angle_deg(const TriangleMesh& mesh);
double longest_edge(const TriangleMesh& mesh);
double shortest_edge(const TriangleMesh& mesh);

/// Returns how many faces the report lists as unrefined, for that reason or for any.
std::uint64_t listed(const Report& report, UnrefinedReason reason);
std::uint64_t listed(const Report& report);
/// Returns the reasons and counts as text, such as "input_angle 3, budget 12".
std::string listed_in_words(const Report& report);

/// Returns the vertices of the output that are not in the input.
std::vector<Vec3> new_vertices(const PolygonMesh& input, const TriangleMesh& output);

/// Tests the promises 1 to 3 of README.md for an input of exact planes (to rounding). The result is verified. Area,
/// volume, Euler number and the length of open and non-manifold edges are the same. Every vertex is on the other
/// surface. There is no new self-intersection, and no edge inside a patch that a flip would improve. As many faces
/// are beyond the bounds as are listed, or no more if sizes vary.
/// Input: `tolerance` - how far rounding has moved the input off its planes, relative to its size.
/// Cost:  vertices times faces.
void expect_promises(const PolygonMesh& input, const Options& options, const Result& result, double tolerance = 1e-9);

}  // namespace remesh
