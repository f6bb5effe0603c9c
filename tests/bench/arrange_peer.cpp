/// CGAL's autorefinement of a soup of triangles, in parallel: `arrange_peer IN.obj` prints how many milliseconds
/// reading and refining took, and the faces before and after, as JSON. The result is not written.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/IO/OBJ.h>
#include <CGAL/Polygon_mesh_processing/autorefinement.h>

#include <array>
#include <cstddef>
#include <cstdio>
#include <vector>

#include "tests/bench/peer_answer.h"
#include "tests/bench/timing.h"

int main(int argc, char** argv) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  namespace processing = CGAL::Polygon_mesh_processing;
  using remesh::bench::milliseconds;
  if (argc != 2) {
    std::fprintf(stderr, "usage: arrange_peer IN.obj\n");
    return 2;
  }
  std::vector<Kernel::Point_3> points;
  std::vector<std::vector<std::size_t>> polygons;
  remesh::bench::PeerAnswer answer;
  bool is_good = true;
  answer.read_ms = milliseconds([&] { is_good = CGAL::IO::read_OBJ(argv[1], points, polygons); });
  if (!is_good) return 1;
  std::vector<std::array<std::size_t, 3>> triangles;
  for (const auto& polygon : polygons) triangles.push_back({polygon.at(0), polygon.at(1), polygon.at(2)});
  answer.faces_in = triangles.size();
  answer.process_ms = milliseconds([&] {
    processing::autorefine_triangle_soup(points, triangles,
                                         CGAL::parameters::concurrency_tag(CGAL::Parallel_if_available_tag()));
  });
  answer.faces_out = triangles.size();
  answer.print();
  return 0;
}
