/// Models of which every face knows the surface that it was made from: cylinders, cones, spheres, tori and what parts
/// are made of, as a CAD program writes them, and shapes that only look curved.
///
/// The corners of all facets lie on the surface, up to the rounding of doubles. Vertices are welded and all used, and
/// faces are counter-clockwise from outside, as in shapes.h. Axes are along z unless said otherwise.
#pragma once

#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

#include "core/mesh/mesh.h"
#include "tests/support/plain_surfaces.h"

namespace remesh::primitives {

struct Model {
  std::string name;
  PolygonMesh mesh;
  std::vector<test::PlainSurface> surfaces;    ///< kFree for faces that have no surface
  IdVector<FaceId, std::uint32_t> surface_of;  ///< by face, an index into `surfaces`
};

/// The models that recognition has to explain wholly. Their faces are polygons, unless a model says that they are
/// triangles.
std::vector<Model> explained();
/// The models that look curved and are not: none of their planes may be claimed as curved.
std::vector<Model> declined();

/// Makes a cylinder of `n` facets with two caps, cut into `rows` rows.
Model cylinder(int n, double radius, double height, int rows = 1);
/// Makes the side of a cylinder alone: `count` of `n` facets. It is open.
Model arc(int n, int count, double radius, double height);
/// Makes the frustum of a cone with two caps.
Model frustum(int n, double lower_radius, double upper_radius, double height);
/// Makes a cone with its apex, and one cap.
Model cone(int n, double radius, double height);
/// Makes a sphere by longitudes and latitudes.
Model globe(int longitudes, int latitudes, double radius);
/// Makes a sphere from an icosahedron that is subdivided `levels` times.
Model icosphere(int levels, double radius);
/// Makes a torus, or its part around `count` of `n` steps, which is open.
Model torus(int n, int count, int m, double radius, double tube);
/// Makes a torus with a flat ring of facets where the tube is highest, and another one where it is lowest. `m` is a
/// multiple of 4.
Model torus_with_flat_rings(int n, int m, double radius, double tube);
/// Makes a box with half sides `half`, plus a radius all around. Each quarter of a circle has `k` facets.
Model rounded_box(const Vec3& half, double radius, int k);
/// Makes a square plate with a countersunk hole in the middle. `n` is a multiple of 8.
Model countersunk_plate(int n);
/// Makes a tube whose wall is thin.
Model tube(int n, double radius, double wall, double height);
/// Makes two plates with a common bore, which do not touch.
Model plates_with_a_common_bore(int n);
/// Makes a plate with a bore and the pin in it. They have the same radius, and the pin is turned by half a facet.
Model pin_in_its_bore(int n);
/// Makes a pipe along x with a branch along z; both are open. `n` is a multiple of 12. The facets of the pipe are the
/// narrower the nearer they are to the sides of the branch.
Model tee(int n);
/// Makes a vase: a surface of revolution whose profile is a wave.
Model vase(int n, int m);
/// Makes `turns` turns of a screw thread, open at both ends. Its crest and root are cylinders, its flanks are free.
Model thread(int n, int turns);
/// Makes a bar with a round corner of `k` facets between two planes that touch the cylinder.
Model bar_with_round_corner(int k);
/// Makes a shaft of `n` facets with a flat instead of `missing` of them. The flat's corners lie on the cylinder.
Model d_shaft(int n, int missing);
/// Makes a prism over a regular polygon with a bore of `n` facets and radius `bore`. Without facets it has no bore.
Model nut(int sides, int n, double bore = 3);
/// Makes a prism over a polygon whose corners lie on a circle, at these angles from each other. They repeat.
Model planks(const std::string& name, const std::vector<double>& degrees);
/// Makes a bar with a corner of three equal planks. The planes beside them do not touch the circle through them.
Model bar_with_three_planks();

/// Cuts each face into triangles: a fan from its first corner.
Model triangulated(const Model& model);
/// Cuts each triangle into four. The new vertices lie on chords, not on the surface.
Model subdivided(const Model& model);
/// Puts two models into one. Equal coordinates stay separate vertices; the surfaces are those of both.
Model joined(const Model& a, const Model& b);

/// How the coordinates of a model are written.
enum class Storage { kDoubles, kFloats, kSixDigits, kNoisyDoubles };
struct Variant {
  std::string name;
  Storage storage = Storage::kDoubles;
  bool is_rotated = false;
  bool is_moved = false;

  friend std::ostream& operator<<(std::ostream& out, const Variant& variant) { return out << variant.name; }
};
/// The variants that recognition has to see through.
std::vector<Variant> variants();

/// Turns, moves and rounds a model, and the truth about it likewise, which is not rounded.
/// Output: `step`, unless it is null - the step to which coordinates are rounded. That of doubles is larger than their
///         last place, because a model is computed in many steps. Noise moves a coordinate by up to half of 1e-9 of the
///         diagonal.
Model varied(const Model& model, const Variant& variant, double* step);

/// Returns the height of the lowest facet over its surface, as seen from the model's lowest curved surface: rounding
/// that is not far smaller than this destroys the model. It is infinite if nothing is curved.
double lowest_chord_height(const Model& model);

}  // namespace remesh::primitives
