// Draws the figures of the README files: figures FOLDER PART.obj
//
// FOLDER gets the drawings, PART.obj the part that they show.

#include <algorithm>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/planes/projection.h"
#include "core/io/obj/obj.h"
#include "core/mesh/pinched_vertices.h"
#include "core/patches/planar/boundary_loops.h"
#include "core/patches/planar/essential_vertices.h"
#include "core/remesh.h"
#include "core/triangulation/carving.h"
#include "core/triangulation/constraint_recovery.h"
#include "core/triangulation/delaunay_flips.h"
#include "core/triangulation/lexicographic_triangulation.h"
#include "tests/figures/bracket.h"
#include "tests/figures/curved_figures.h"
#include "tests/figures/detail_figures.h"
#include "tests/figures/part.h"
#include "tests/figures/refined_patch.h"
#include "tests/figures/render.h"
#include "tests/figures/style.h"
#include "tests/figures/surface_figures.h"
#include "tests/figures/svg.h"

namespace remesh::figures {
namespace {

constexpr std::size_t kPartFaces = 4800;

void write_file(const std::filesystem::path& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary);
  if (!(out << text).flush()) throw std::runtime_error("cannot write " + path.string());
  std::cout << path.string() << ": " << text.size() / 1024 << " KiB\n";
}

Shape shape_of_part(const Part& part) {
  Shape shape;
  const auto positions = part.surface.positions.items();
  shape.positions.assign(positions.begin(), positions.end());
  for (std::uint32_t f = 0; f < part.surface.face_count(); ++f) {
    const auto [a, b, c] = corners_of(part.surface, FaceId(f));
    shape.faces.push_back({a.value, b.value, c.value});
    shape.patch.push_back(part.patches.of_face[FaceId(f)].value);
  }
  return shape;
}

/// Draws the picture on the first screen of the README.
std::string before_and_after(const PolygonMesh& mesh, const Part& part, RunControl& control) {
  constexpr int kElements = 16;
  Options options;
  options.elements_per_circle = kElements;
  const Result result = remesh_surface(mesh, options, RunSettings{}, control);
  Panel before("Before", count(part.surface.face_count()) + " triangles, coordinates rounded to six decimals");
  draw(shape_of_part(part), Paint::kLight, 0.35, before);
  const Quality& quality = result.report.output.quality;
  Panel after("After", count(result.mesh.faces.size()) + " triangles, smallest angle " +
                           number(std::floor(10 * quality.min_angle_deg) / 10) + "°, 16 edges per full turn");
  draw(shape_of(result), Paint::kLight, 0.55, after);
  return to_svg({before, after}, 480, 450);
}

std::string regions_and_result(const Part& part, const Result& result) {
  Panel input("coplanar_regions, patches",
              count(part.surface.face_count()) + " faces, " + count(part.patches.count()) + " patches");
  draw(shape_of_part(part), Paint::kPatches, 0.3, input);
  Panel output("assembly", count(result.mesh.faces.size()) + " faces, the same patches");
  draw(shape_of(result), Paint::kPatches, 0.5, output);
  return to_svg({input, output}, 420, 400);
}

/// Draws the three settings between which a user chooses: the shape decides, one size for all, or the gaps decide.
std::string three_settings(const PolygonMesh& mesh, RunControl& control) {
  std::vector<Panel> panels;
  const auto add = [&](const std::string& title, const Options& options) {
    const Result result = remesh_surface(mesh, options, RunSettings{}, control);
    const Quality& quality = result.report.output.quality;
    panels.emplace_back(title, count(result.mesh.faces.size()) + " triangles, edges " +
                                   number(quality.edge_length.min) + " to " + number(quality.edge_length.max) + " mm");
    draw(shape_of(result), Paint::kSizes, 0.3, panels.back());
  };
  Options options;
  add("the default: min_angle_deg 25", options);
  options.max_edge_length = 5;
  add("max_edge_length 5", options);
  options.max_edge_length.reset();
  options.proximity = 1;
  add("proximity 1", options);
  return to_svg(panels, 330, 310);
}

/// Draws one patch in each step of its way through the plane.
class PatchFigures {
 public:
  PatchFigures(const Part& part, PatchId patch, RunControl& control) : part_(part), patch_(patch), control_(control) {
    const BoundaryLoops all = boundary_loops(part.surface, part.adjacency, part.patches, control);
    essential_ = essential_vertices(part.surface, part.adjacency, all,
                                    IdVector<VertexId, std::uint8_t>(part.surface.vertex_count(), 0),
                                    pinched_vertices(part.surface, part.adjacency, control), part.tolerance, control);
    std::vector<Edge3> edges;
    std::vector<Vec3> points;
    for (std::uint32_t l = all.patch_begin[patch.value]; l < all.patch_begin[patch.value + 1]; ++l) {
      Loop loop;
      for (const std::uint32_t h : all.loop(l)) loop.push_back(part.adjacency.from(h));
      for (std::size_t k = 0; k < loop.size(); ++k) {
        points.push_back(part.surface.local[loop[k]]);
        edges.push_back({part.surface.local[loop[k]], part.surface.local[loop[(k + 1) % loop.size()]]});
      }
      loops_.push_back(std::move(loop));
    }
    const Plane& plane = part.patches.planes[patch];
    frame_ = make_frame(plane.normal, plane.origin, points, edges, ReferenceAxis::kDominantEdge, {}, kPatchGrid);
    collect_points();
  }

  std::string loops_and_essential_vertices() {
    std::size_t on_boundary = 0;
    for (const Loop& loop : loops_) on_boundary += loop.size();
    Panel loops("boundary_loops", count(loops_.size()) + " loops through " + count(on_boundary) + " vertices");
    Panel kept("essential_vertices", count(points_.size()) + " vertices stay");
    for (Panel* panel : {&loops, &kept})
      for (const FaceId f : part_.patches.faces_of(patch_)) {
        const auto [a, b, c] = corners_of(part_.surface, f);
        panel->polygon({at(a), at(b), at(c)}, kPaper, kFaint, 0.4);
      }
    for (const Loop& loop : loops_) {
      for (std::size_t k = 0; k < loop.size(); ++k) {
        const Vec2 from = at(loop[k]), to = at(loop[(k + 1) % loop.size()]);
        loops.line(from, to, is_hole(loop) ? kHole : kOuter, 2.2);
        kept.line(from, to, kInk, 1);
      }
      for (const VertexId v : loop) loops.dot(at(v), 2.2, is_hole(loop) ? kHole : kOuter);
      for (const VertexId v : loop)
        if (!essential_[v]) kept.dot(at(v), 1.6, kFaint);
    }
    for (const Vec2 p : points_) kept.dot(p, 3, kOuter);
    return to_svg({loops, kept}, 420, 330);
  }

  std::string triangulation() {
    Triangulation2d mesh = lexicographic_triangulation(points_, control_);
    Panel sweep("lexicographic_triangulation", "each point joined to all hull edges that it sees");
    draw_triangles(mesh, sweep);
    delaunay_flips(points_, mesh, control_);
    Panel flips("delaunay_flips", "red: loop edges that are not there yet");
    draw_triangles(mesh, flips);
    draw_missing(mesh, flips);
    if (constraint_recovery(points_, segments_, mesh, control_) != TriangulationOutcome::kDone)
      throw std::runtime_error("the part's loops cross");
    Panel recovery("constraint_recovery", "every loop edge is an edge");
    draw_triangles(mesh, recovery);
    if (carving(segments_, mesh, control_) != TriangulationOutcome::kDone)
      throw std::runtime_error("the part's loops contradict each other");
    Panel carved("carving", count(mesh.triangle_count()) + " triangles, inside the loops only");
    draw_triangles(mesh, carved);
    return to_svg({sweep, flips, recovery, carved}, 420, 330);
  }

 private:
  using Loop = std::vector<VertexId>;

  Vec2 at(VertexId v) const { return to_plane(frame_, part_.surface.local[v]); }

  bool is_hole(const Loop& loop) const {
    double doubled_area = 0;
    for (std::size_t k = 0; k < loop.size(); ++k) doubled_area += cross(at(loop[k]), at(loop[(k + 1) % loop.size()]));
    return doubled_area < 0;
  }

  void collect_points() {
    std::vector<std::vector<Vec2>> kept;
    for (const Loop& loop : loops_) {
      kept.emplace_back();
      for (const VertexId v : loop)
        if (essential_[v]) kept.back().push_back(at(v));
      points_.insert(points_.end(), kept.back().begin(), kept.back().end());
    }
    std::sort(points_.begin(), points_.end());
    const auto index = [this](Vec2 p) {
      return static_cast<std::uint32_t>(std::lower_bound(points_.begin(), points_.end(), p) - points_.begin());
    };
    for (const auto& loop : kept)
      for (std::size_t k = 0; k < loop.size(); ++k)
        segments_.push_back({index(loop[k]), index(loop[(k + 1) % loop.size()])});
  }

  void draw_triangles(const Triangulation2d& mesh, Panel& panel) const {
    for (std::uint32_t h = 0; h < mesh.half_edge_count(); h += 3)
      panel.polygon({points_[mesh.from(h)], points_[mesh.to(h)], points_[mesh.apex(h)]}, kPaper, mix(kInk, kFaint, 0.4),
                    0.6);
    for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h)
      if (mesh.is_constrained(h)) panel.line(points_[mesh.from(h)], points_[mesh.to(h)], kOuter, 1.8);
    for (const Vec2 p : points_) panel.dot(p, 2, kInk);
  }

  void draw_missing(const Triangulation2d& mesh, Panel& panel) const {
    std::vector<Segment> edges;
    for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h) {
      edges.push_back({mesh.from(h), mesh.to(h)});
      edges.push_back({mesh.to(h), mesh.from(h)});
    }
    std::sort(edges.begin(), edges.end());
    for (const Segment& s : segments_)
      if (!std::binary_search(edges.begin(), edges.end(), s)) panel.line(points_[s[0]], points_[s[1]], kMissing, 1.8);
  }

  const Part& part_;
  PatchId patch_;
  RunControl& control_;
  EssentialVertices essential_;
  std::vector<Loop> loops_;
  Frame frame_;
  std::vector<Vec2> points_;       // essential ones, in lexicographic order
  std::vector<Segment> segments_;  // the loops' edges between them
};

/// Returns the face of the base that carries the rib. Its outline is not convex, and it has two slots.
PatchId upper_face_of_base(const Part& part) {
  PatchId best;
  for (std::uint32_t p = 0; p < part.patches.count(); ++p) {
    const bool is_upward = part.patches.planes[PatchId(p)].normal.z > 0.99;
    if (is_upward &&
        (!best.is_valid() || part.patches.faces_of(PatchId(p)).size() > part.patches.faces_of(best).size()))
      best = PatchId(p);
  }
  return best;
}

std::string to_obj(const PolygonMesh& mesh, RunControl& control) {
  TriangleMesh triangles;
  triangles.positions = mesh.positions;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const auto corners = mesh.face(FaceId(f));
    triangles.faces.push_back({corners[0], corners[1], corners[2]});
  }
  return write_obj(triangles, {"The bracket of the README's picture, millimetres. Made by ./dev figures."}, control);
}

void draw_all(const std::filesystem::path& folder, const std::filesystem::path& part_file) {
  RunControl control;
  const PolygonMesh mesh = make_bracket(kPartFaces);
  write_file(part_file, to_obj(mesh, control));
  Options options;
  options.refine = false;
  options.surface_tolerance = 0;
  const Result result = remesh_surface(mesh, options, RunSettings{}, control);
  const Part part = make_part(mesh, result.report.plane_tolerance, control);
  write_file(folder / "before_after.svg", before_and_after(mesh, part, control));
  write_file(folder / "patches.svg", regions_and_result(part, result));
  PatchFigures patch(part, upper_face_of_base(part), control);
  write_file(folder / "essential_vertices.svg", patch.loops_and_essential_vertices());
  write_file(folder / "triangulation.svg", patch.triangulation());
  write_file(folder / "refinement.svg", refinement_of_patch(part, upper_face_of_base(part), control));
  write_file(folder / "sharp_corner.svg", sharp_corner(control));
  write_file(folder / "details.svg", details(control));
  write_file(folder / "surfaces.svg", recognised_surfaces(mesh, control));
  write_file(folder / "declined_surfaces.svg", declined_surfaces(control));
  write_file(folder / "elements_per_circle.svg", elements_per_circle(control));
  write_file(folder / "coarser_surfaces.svg", coarser_surfaces(control));
  write_file(folder / "proven_distance.svg", proven_distance());
  write_file(folder / "three_settings.svg", three_settings(mesh, control));
}

}  // namespace
}  // namespace remesh::figures

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: figures FOLDER PART.obj\n";
    return 2;
  }
  try {
    remesh::figures::draw_all(argv[1], argv[2]);
  } catch (const std::exception& error) {
    std::cerr << "figures: " << error.what() << '\n';
    return 1;
  }
}
