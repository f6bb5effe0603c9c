/// What anybody can measure on a refined surface without trusting its report.
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
Options with_angle(double degrees);
Options with_length(double length);

struct Bounds {
  double min_angle_deg = 0;
  double max_edge_length = std::numeric_limits<double>::infinity();
  double max_area = std::numeric_limits<double>::infinity();
};

/// The bounds that options ask for; lengths given as a fraction are left to the caller.
Bounds bounds_of(const Options& options);

/// Do gaps or short edges ask for sizes of their own? Then faces may be listed that meet all of Bounds.
bool do_sizes_vary(const Options& options);

/// Faces that miss a bound. `slack`: bounds are so much wider, relatively; negative: tighter.
std::vector<FaceId> faces_beyond(const TriangleMesh& mesh, const Bounds& bounds, double slack = 0);

double smallest_angle_deg(const TriangleMesh& mesh);
double longest_edge(const TriangleMesh& mesh);
double shortest_edge(const TriangleMesh& mesh);

/// How many faces the report lists as unrefined, for that reason or for any.
std::uint64_t listed(const Report& report, UnrefinedReason reason);
std::uint64_t listed(const Report& report);
/// "input_angle 3, budget 12"
std::string listed_in_words(const Report& report);

/// Vertices of the output that are none of the input.
std::vector<Vec3> new_vertices(const PolygonMesh& input, const TriangleMesh& output);

/// The promises 1 to 3 of README.md, for an input of exact planes (to rounding): verified; the same area, volume, Euler
/// number and length of open and non-manifold edges; every vertex on the other surface; no new self-intersection; no
/// edge inside a patch that a flip would improve; the faces beyond the bounds are as many as are listed, or no more
/// where sizes vary.
/// `tolerance`: how far rounding has moved the input off its planes, of its size.
/// Cost:  vertices times faces.
void expect_promises(const PolygonMesh& input, const Options& options, const Result& result, double tolerance = 1e-9);

}  // namespace remesh
