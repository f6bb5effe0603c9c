/// CGAL's isotropic remeshing, from OBJ file to OBJ file: `isotropic_peer IN OUT EDGE_LENGTH` prints how many
/// milliseconds reading, remeshing and writing took, and the faces before and after, as JSON.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/IO/polygon_mesh_io.h>
#include <CGAL/Polygon_mesh_processing/detect_features.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Surface_mesh.h>

#include <cstdio>
#include <cstdlib>

#include "tests/bench/peer_answer.h"
#include "tests/bench/timing.h"

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Edge = boost::graph_traits<Mesh>::edge_descriptor;
namespace processing = CGAL::Polygon_mesh_processing;

constexpr double kSharpDegrees = 30;
constexpr unsigned kIterations = 3;

/// Sharp edges stay where they are; they may be cut.
void remesh_isotropically(Mesh& mesh, double edge_length) {
  const auto is_sharp = mesh.add_property_map<Edge, bool>("e:is_sharp", false).first;
  processing::detect_sharp_edges(mesh, kSharpDegrees, is_sharp);
  processing::isotropic_remeshing(
      mesh.faces(), edge_length, mesh,
      CGAL::parameters::number_of_iterations(kIterations).edge_is_constrained_map(is_sharp));
}

}  // namespace

int main(int argc, char** argv) {
  using remesh::bench::milliseconds;
  const double edge_length = argc == 4 ? std::atof(argv[3]) : 0;
  if (!(edge_length > 0)) {
    std::fprintf(stderr, "usage: isotropic_peer IN OUT EDGE_LENGTH\n");
    return 2;
  }
  Mesh mesh;
  remesh::bench::PeerAnswer answer;
  bool is_good = true;
  answer.read_ms = milliseconds([&] { is_good = CGAL::IO::read_polygon_mesh(argv[1], mesh); });
  if (!is_good) return 1;
  answer.faces_in = mesh.number_of_faces();
  answer.process_ms = milliseconds([&] { remesh_isotropically(mesh, edge_length); });
  mesh.collect_garbage();
  answer.faces_out = mesh.number_of_faces();
  answer.write_ms = milliseconds([&] { is_good = CGAL::IO::write_polygon_mesh(argv[2], mesh); });
  answer.print();
  return is_good ? 0 : 1;
}
