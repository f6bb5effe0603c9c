/// The coarsest mesh that a method of CGAL makes within a distance of its input.
///
/// `coarse_peer distance A B` prints the distance between two surfaces.
/// `coarse_peer METHOD IN OUT DISTANCE` searches for the largest tolerance with which the method stays within the
/// distance, as it is measured here, and writes the mesh with the fewest faces. The methods promise no distance, so
/// their tolerance alone says little. They are:
/// - `adaptive`: isotropic remeshing, whose edges are shorter where the surface bends more;
/// - `planar`: regions of almost one plane become one polygon each.
///
/// `coarse_peer adaptive_once IN OUT TOLERANCE MIN_EDGE` remeshes as `adaptive` does, but once, with that tolerance.
///
/// The answer is JSON: the faces, the distance as a lower bound that is at most 1 % too small, and the method's own
/// tolerance. There are no faces if nothing stays within the distance.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <boost/property_map/vector_property_map.hpp>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/Adaptive_sizing_field.h>
#include <CGAL/Polygon_mesh_processing/IO/polygon_mesh_io.h>
#include <CGAL/Polygon_mesh_processing/bbox.h>
#include <CGAL/Polygon_mesh_processing/detect_features.h>
#include <CGAL/Polygon_mesh_processing/region_growing.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Polygon_mesh_processing/remesh_planar_patches.h>
#include <CGAL/Surface_mesh.h>

#include "tests/bench/surface_distance.h"

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Edge = boost::graph_traits<Mesh>::edge_descriptor;
using remesh::bench::distance_between;
using remesh::bench::DistanceTriangle;
using remesh::bench::SurfaceDistance;
using Triangles = std::vector<DistanceTriangle>;
namespace processing = CGAL::Polygon_mesh_processing;
namespace parameters = CGAL::parameters;

constexpr double kSharpDegrees = 30;
constexpr unsigned kIterations = 3;
/// The first tolerance, and the last one, as multiples of the distance.
constexpr double kLargestTolerance = 4;
constexpr double kSmallestTolerance = 1.0 / 64;
/// Distances below this part of the diagonal are rounding.
constexpr double kRounding = 1e-6;
/// The search ends when the tolerance is known to this factor. Isotropic remeshing is slow.
constexpr double kAdaptiveStep = 1.25, kPlanarStep = 1.1;
/// Faces are of almost one plane if they turn by less than one of these angles.
constexpr std::array<double, 4> kPlaneDegrees{10, 20, 40, 60};
/// Faces of exactly one plane turn by less than a quarter of a degree, because their coordinates are rounded.
constexpr double kExactCosine = 0.99999;

using Method = std::function<std::optional<Mesh>(double tolerance)>;

struct Found {
  Mesh mesh;
  double distance;
  double tolerance;
};

Triangles triangles_of(const Mesh& mesh) {
  Triangles triangles;
  const auto at = [&](Mesh::Halfedge_index h) {
    const Kernel::Point_3& p = mesh.point(mesh.target(h));
    return remesh::bench::DistanceKernel::Point_3(p.x(), p.y(), p.z());
  };
  for (const Mesh::Face_index f : mesh.faces()) {
    const Mesh::Halfedge_index first = mesh.halfedge(f);
    for (Mesh::Halfedge_index h = mesh.next(first); mesh.next(h) != first; h = mesh.next(h))
      triangles.emplace_back(at(first), at(h), at(mesh.next(h)));
  }
  return triangles;
}

double diagonal(const CGAL::Bbox_3& box) { return std::hypot(box.x_span(), box.y_span(), box.z_span()); }
double diagonal(const Mesh& mesh) { return diagonal(processing::bbox(mesh)); }
double diagonal(const Triangles& triangles) { return diagonal(CGAL::bbox_3(triangles.begin(), triangles.end())); }

/// Sharp edges stay where they are; they may be cut, and cuts may be removed. No edge needs to be shorter than the
/// distance.
std::optional<Mesh> remesh_adaptively(Mesh mesh, double tolerance, double distance) {
  const auto is_sharp = mesh.add_property_map<Edge, bool>("e:is_sharp", false).first;
  processing::detect_sharp_edges(mesh, kSharpDegrees, is_sharp);
  processing::Adaptive_sizing_field<Mesh> field(tolerance, std::pair(distance, diagonal(mesh)), mesh.faces(), mesh);
  processing::isotropic_remeshing(
      mesh.faces(), field, mesh,
      parameters::number_of_iterations(kIterations).edge_is_constrained_map(is_sharp).relax_constraints(true));
  mesh.collect_garbage();
  return mesh;
}

std::optional<Mesh> remesh_exact_planes(Mesh mesh) {
  Mesh out;
  processing::remesh_planar_patches(mesh, out, parameters::cosine_of_maximum_angle(kExactCosine));
  return out;
}

std::optional<Mesh> remesh_almost_planes(Mesh mesh, double tolerance, double angle_deg) {
  std::vector<std::size_t> regions(num_faces(mesh)), corners(num_vertices(mesh), static_cast<std::size_t>(-1));
  std::vector<bool> is_border(num_edges(mesh), false);
  boost::vector_property_map<Kernel::Vector_3> normals;
  const auto region_map = CGAL::make_random_access_property_map(regions);
  const auto corner_map = CGAL::make_random_access_property_map(corners);
  const auto border_map = CGAL::make_random_access_property_map(is_border);
  const double cosine = std::cos(angle_deg * std::numbers::pi / 180);
  const std::size_t region_count = processing::region_growing_of_planes_on_faces(
      mesh, region_map,
      parameters::cosine_of_maximum_angle(cosine).region_primitive_map(normals).maximum_distance(tolerance));
  const std::size_t corner_count = processing::detect_corners_of_regions(
      mesh, region_map, region_count, corner_map,
      parameters::cosine_of_maximum_angle(cosine).maximum_distance(tolerance).edge_is_constrained_map(border_map));
  Mesh out;
  if (!processing::remesh_almost_planar_patches(mesh, out, region_count, corner_count, region_map, corner_map,
                                                border_map, parameters::patch_normal_map(normals)))
    return std::nullopt;
  return out;
}

/// Returns the mesh and its distance if it stays within the distance.
std::optional<Found> tried(const Method& method, double tolerance, const Triangles& before, double distance) {
  std::optional<Mesh> mesh;
  try {
    mesh = method(tolerance);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "coarse_peer: with a tolerance of %g: %s\n", tolerance, error.what());
  }
  if (!mesh || num_faces(*mesh) == 0) return std::nullopt;
  const SurfaceDistance measured = distance_between(before, triangles_of(*mesh), distance, distance);
  if (measured.lower > distance) return std::nullopt;
  return Found{std::move(*mesh), 0, tolerance};
}

void keep_coarser(std::optional<Found>& best, std::optional<Found> other) {
  if (other && (!best || num_faces(other->mesh) < num_faces(best->mesh))) best = std::move(other);
}

/// Halves the tolerance until the mesh stays within the distance, and then looks for a larger one between the last two.
std::optional<Found> search(const Method& method, double step, const Triangles& before, double distance) {
  std::optional<Found> best;
  double good = kLargestTolerance * distance, bad = 0;
  while (!best) {
    best = tried(method, good, before, distance);
    if (best) break;
    bad = good;
    good /= 2;
    if (good < kSmallestTolerance * distance) return std::nullopt;
  }
  while (bad > step * good) {
    const double middle = std::sqrt(good * bad);
    std::optional<Found> other = tried(method, middle, before, distance);
    (other ? good : bad) = middle;
    keep_coarser(best, std::move(other));
  }
  return best;
}

std::optional<Found> coarsest(const std::string& method, const Mesh& mesh, double distance) {
  const Triangles before = triangles_of(mesh);
  std::optional<Found> best;
  if (method == "adaptive") {
    best = search([&](double tolerance) { return remesh_adaptively(mesh, tolerance, distance); }, kAdaptiveStep, before,
                  distance);
  } else {
    best = tried([&](double) { return remesh_exact_planes(mesh); }, 0, before, distance);
    for (const double angle_deg : kPlaneDegrees)
      keep_coarser(best, search([&](double tolerance) { return remesh_almost_planes(mesh, tolerance, angle_deg); },
                                kPlanarStep, before, distance));
  }
  if (best)
    best->distance = distance_between(before, triangles_of(best->mesh), kRounding * diagonal(mesh), HUGE_VAL).lower;
  return best;
}

std::optional<Mesh> read(const char* path) {
  Mesh mesh;
  if (!processing::IO::read_polygon_mesh(path, mesh) || num_faces(mesh) == 0) return std::nullopt;
  return mesh;
}

/// The surface need not be a manifold.
std::optional<Triangles> read_triangles(const char* path) {
  std::vector<Kernel::Point_3> points;
  std::vector<std::vector<std::size_t>> faces;
  if (!CGAL::IO::read_polygon_soup(path, points, faces)) return std::nullopt;
  Triangles triangles;
  const auto at = [&](std::size_t i) {
    return remesh::bench::DistanceKernel::Point_3(points[i].x(), points[i].y(), points[i].z());
  };
  for (const std::vector<std::size_t>& face : faces)
    for (std::size_t i = 2; i < face.size(); ++i) triangles.emplace_back(at(face[0]), at(face[i - 1]), at(face[i]));
  return triangles;
}

int print_distance(const char* a, const char* b) {
  const std::optional<Triangles> first = read_triangles(a), second = read_triangles(b);
  if (!first || !second) return 1;
  const SurfaceDistance measured = distance_between(*first, *second, kRounding * diagonal(*first), HUGE_VAL);
  std::printf(R"({"distance": %.9g, "upper": %.9g})"
              "\n",
              measured.lower, measured.upper);
  return 0;
}

int print_coarsest(const std::string& method, const char* in, const char* out, double distance) {
  const std::optional<Mesh> mesh = read(in);
  if (!mesh) return 1;
  const std::optional<Found> found = coarsest(method, *mesh, distance);
  if (!found) {
    std::puts(R"({"faces": null})");
    return 0;
  }
  std::printf(R"({"faces": %zu, "distance": %.9g, "tolerance": %.9g})"
              "\n",
              std::size_t{num_faces(found->mesh)}, found->distance, found->tolerance);
  return CGAL::IO::write_polygon_mesh(out, found->mesh, parameters::stream_precision(17)) ? 0 : 1;
}

/// Writes what a method has made of a mesh.
int print_made(const Mesh& made, const char* out) {
  std::printf(R"({"faces": %zu})"
              "\n",
              std::size_t{num_faces(made)});
  return CGAL::IO::write_polygon_mesh(out, made, parameters::stream_precision(17)) ? 0 : 1;
}

int print_adaptive(const char* in, const char* out, double tolerance, double min_edge) {
  std::optional<Mesh> mesh = read(in);
  return mesh ? print_made(*remesh_adaptively(*std::move(mesh), tolerance, min_edge), out) : 1;
}

/// Remeshes the exact planes of a mesh.
int print_planes(const char* in, const char* out) {
  std::optional<Mesh> mesh = read(in);
  if (!mesh) return 1;
  return print_made(*remesh_exact_planes(*std::move(mesh)), out);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  if (what == "distance" && argc == 4) return print_distance(argv[2], argv[3]);
  if (what == "planes" && argc == 4) return print_planes(argv[2], argv[3]);
  if (what == "adaptive_once" && argc == 6)
    return print_adaptive(argv[2], argv[3], std::atof(argv[4]), std::atof(argv[5]));
  if ((what == "adaptive" || what == "planar") && argc == 5)
    return print_coarsest(what, argv[2], argv[3], std::atof(argv[4]));
  std::fprintf(
      stderr,
      "usage: coarse_peer distance A B | coarse_peer planes IN OUT |\n"
      "       coarse_peer adaptive_once IN OUT TOLERANCE MIN_EDGE | coarse_peer adaptive|planar IN OUT DISTANCE\n");
  return 2;
}
