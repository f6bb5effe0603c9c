/// CGAL's remesh_planar_patches, from OBJ file to OBJ file: `planar_peer IN OUT` prints how many milliseconds reading,
/// remeshing and writing took, and the faces before and after, as JSON.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/IO/polygon_mesh_io.h>
#include <CGAL/Polygon_mesh_processing/remesh_planar_patches.h>
#include <CGAL/Surface_mesh.h>

#include <cstdio>

#include "tests/bench/peer_answer.h"
#include "tests/bench/timing.h"

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

/// Faces whose dihedral angle differs from a flat one by less than a quarter of a degree are one plane. CGAL's exact
/// mode merges nothing in a turned part, since its coordinates are rounded.
constexpr double kCosine = 0.99999;

}  // namespace

int main(int argc, char** argv) {
  using remesh::bench::milliseconds;
  if (argc != 3) {
    std::fprintf(stderr, "usage: planar_peer IN OUT\n");
    return 2;
  }
  Mesh in, out;
  remesh::bench::PeerAnswer answer;
  bool is_good = true;
  answer.read_ms = milliseconds([&] { is_good = CGAL::IO::read_polygon_mesh(argv[1], in); });
  if (!is_good) return 1;
  answer.process_ms = milliseconds([&] {
    CGAL::Polygon_mesh_processing::remesh_planar_patches(in, out, CGAL::parameters::cosine_of_maximum_angle(kCosine));
  });
  answer.write_ms = milliseconds([&] { is_good = CGAL::IO::write_polygon_mesh(argv[2], out); });
  answer.faces_in = in.number_of_faces();
  answer.faces_out = out.number_of_faces();
  answer.print();
  return is_good ? 0 : 1;
}
