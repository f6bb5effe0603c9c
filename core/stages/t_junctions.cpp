#include "core/stages/t_junctions.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/base/blocks.h"
#include "core/base/parallel.h"
#include "core/base/tolerance.h"
#include "core/mesh/face_geometry.h"
#include "core/refinement/box_tree.h"
#include "core/stages/mend_faces.h"

namespace remesh {
namespace {

constexpr std::size_t kBlock = 256;

/// Nothing is noted on the boxes.
struct NoTag {
  void join(NoTag) {}
};
using VertexTree = BoxTree<NoTag>;

/// A vertex on an open edge: where along it, and how far off.
struct Junction {
  FaceId face;
  VertexId vertex;
  double distance = 0;
  std::uint32_t half_edge = 0;
  double along = 0;
};

/// Does the segment come within `margin` of the box? Never no by rounding alone if it does by more than that.
bool is_near(const Vec3& a, const Vec3& b, double margin, const FloatBox& box) {
  double from = 0, to = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = box.min[axis] - margin, high = box.max[axis] + margin, way = b[axis] - a[axis];
    if (way == 0) {
      if (a[axis] < low || a[axis] > high) return false;
      continue;
    }
    const double first = (low - a[axis]) / way, second = (high - a[axis]) / way;
    from = std::max(from, std::min(first, second));
    to = std::min(to, std::max(first, second));
  }
  constexpr double kRounding = 1e-12;
  return from <= to + kRounding;
}

class Search {
 public:
  Search(const Surface& surface, const Adjacency& edges, double tolerance, const std::vector<std::uint8_t>& as_it_is,
         RunControl& control)
      : surface_(surface), edges_(edges), tolerance_(tolerance), as_it_is_(as_it_is), control_(control) {}

  /// Output: by half-edge, in order along it; every vertex once a face.
  std::vector<Junction> run() {
    find_boundary();
    if (open_.empty()) return {};
    std::vector<VertexTree::Entry> entries(vertices_.size());
    for (std::size_t i = 0; i < vertices_.size(); ++i) entries[i].box.add(surface_.local[vertices_[i]]);
    const VertexTree tree(entries, control_);
    const auto found =
        map_blocks<std::vector<Junction>>(open_.size(), kBlock, control_, [&](std::size_t begin, std::size_t end) {
          std::vector<Junction> junctions;
          for (std::size_t i = begin; i < end; ++i) find_on(open_[i], tree, junctions);
          return junctions;
        });
    std::vector<Junction> all;
    for (const auto& junctions : found) all.insert(all.end(), junctions.begin(), junctions.end());
    // On the nearest edge only, if a face has several such.
    const auto key = [](const Junction& j) { return std::tuple(j.face, j.vertex, j.distance, j.half_edge); };
    std::sort(all.begin(), all.end(), [&](const Junction& a, const Junction& b) { return key(a) < key(b); });
    all.erase(
        std::unique(all.begin(), all.end(),
                    [](const Junction& a, const Junction& b) { return a.face == b.face && a.vertex == b.vertex; }),
        all.end());
    std::sort(all.begin(), all.end(), [&](const Junction& a, const Junction& b) {
      return a.half_edge != b.half_edge ? a.half_edge < b.half_edge
             : a.along != b.along       ? a.along < b.along
                                        : surface_.local[a.vertex] < surface_.local[b.vertex];
    });
    return all;
  }

 private:
  void find_boundary() {
    std::uint32_t looks = 0;
    for (const EdgeId e : edges_.odd_edges()) {
      if (looks++ % 4096 == 0) control_.check();
      const std::uint32_t h = edges_.half_edges(e)[0];
      if (edges_.half_edges(e).size() > 1 || edges_.from(h) == edges_.to(h)) continue;
      vertices_.insert(vertices_.end(), {edges_.from(h), edges_.to(h)});
      const FaceId f = edges_.face_of(h);
      const bool takes_vertices = as_it_is_.empty() || as_it_is_[surface_.face_source[f].value] == 0;
      if (takes_vertices && !is_without_area(surface_, f)) open_.push_back(h);
    }
    if (open_.empty()) return;
    sort_all(vertices_.begin(), vertices_.end());
    vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
  }

  void find_on(std::uint32_t h, const VertexTree& tree, std::vector<Junction>& junctions) const {
    const Vec3 a = surface_.local[edges_.from(h)], b = surface_.local[edges_.to(h)];
    const Vec3 way = b - a;
    const double length = norm(way);
    if (!(length > 2 * tolerance_)) return;
    const auto bound = [&](const VertexTree::Entry& entry) {
      return is_near(a, b, tolerance_, entry.box) ? 0 : HUGE_VAL;
    };
    const double all = 1;
    std::uint32_t tests = 0;
    tree.search(all, bound, [&](std::size_t slot) {
      if (++tests % 4096 == 0) control_.check();
      const VertexId v = vertices_[tree.number(slot)];
      const Vec3 p = surface_.local[v];
      const double along = dot(p - a, way) / (length * length);
      const double distance = norm(p - (a + along * way));
      if (!(distance <= tolerance_) || !(norm(p - a) > tolerance_) || !(norm(p - b) > tolerance_)) return;
      if (!(along > 0 && along < 1)) return;
      const auto loop = surface_.face(edges_.face_of(h));
      if (std::find(loop.begin(), loop.end(), v) != loop.end()) return;
      junctions.push_back({edges_.face_of(h), v, distance, h, along});
    });
  }

  const Surface& surface_;
  const Adjacency& edges_;
  double tolerance_;
  const std::vector<std::uint8_t>& as_it_is_;
  RunControl& control_;
  std::vector<std::uint32_t> open_;  ///< half-edges
  std::vector<VertexId> vertices_;   ///< of the open boundary
};

}  // namespace

bool split_t_junctions(Surface& surface, const Adjacency& edges, double tolerance,
                       const std::vector<std::uint8_t>& as_it_is, Mend mend, std::vector<Diagnostic>& diagnostics,
                       RunControl& control) {
  std::vector<Junction> junctions = Search(surface, edges, tolerance, as_it_is, control).run();
  if (junctions.empty()) return false;
  const FaceGeometries geometry = face_geometry(surface, control);
  junctions.erase(std::remove_if(junctions.begin(), junctions.end(),
                                 [&](const Junction& j) { return geometry[j.face].height < kThinFace * tolerance; }),
                  junctions.end());
  if (junctions.empty()) return false;
  Diagnostic found{DiagnosticCode::kTJunction, 0, {}, ""};
  found.message = mend == Mend::kYes
                      ? "vertices lie on an open edge of a face without them: it was split there; elements are vertices"
                      : "vertices lie on an open edge of a face without them; elements are vertices";
  for (const Junction& j : junctions) found.add(surface.vertex_source[j.vertex].value);
  diagnostics.push_back(std::move(found));
  if (mend == Mend::kNo) return false;
  Surface split;
  std::vector<VertexId> loop;
  auto next = junctions.begin();
  for (std::uint32_t f = 0; f < surface.face_count(); ++f) {
    loop.clear();
    for (std::uint32_t h = surface.face_begin[f]; h < surface.face_begin[f + 1]; ++h) {
      loop.push_back(surface.corners[h]);
      for (; next != junctions.end() && next->half_edge == h; ++next) loop.push_back(next->vertex);
    }
    split.add_face(loop, surface.face_source[FaceId(f)], surface.label(FaceId(f)));
  }
  surface.take_faces(std::move(split));
  return true;
}

}  // namespace remesh
