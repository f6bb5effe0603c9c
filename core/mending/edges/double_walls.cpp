#include "core/mending/edges/double_walls.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/stoppable.h"
#include "core/base/union_find.h"
#include "core/mending/common/body_labels.h"
#include "core/mending/polygons/polygon_split.h"

namespace remesh {
namespace {

class Walls {
 public:
  Walls(const Surface& surface, const Adjacency& edges, const BodyLabels& labels, double tolerance,
        const std::vector<std::uint8_t>& keep_verbatim, RunControl& control)
      : surface_(surface),
        edges_(edges),
        labels_(labels),
        tolerance_(tolerance),
        keep_verbatim_(keep_verbatim),
        control_(control) {}

  /// Returns whether all faces of a piece are triangles of the input. Pieces of a polygon have to cover just that
  /// polygon, so no larger polygon may replace them.
  bool are_triangles_of_input(const std::vector<FaceId>& piece) {
    if (faces_of_source_.empty()) {
      StopCheck check(control_);
      for (std::uint32_t f = 0; f < surface_.face_count(); ++f) {
        check();
        const std::uint32_t source = surface_.face_source[FaceId(f)].value;
        if (source >= faces_of_source_.size()) faces_of_source_.resize(source + 1, 0);
        ++faces_of_source_[source];
      }
    }
    return std::all_of(piece.begin(), piece.end(), [&](FaceId f) {
      return surface_.face(f).size() == 3 && faces_of_source_[surface_.face_source[f].value] == 1;
    });
  }

  /// Output: the new faces; none if no wall changes.
  FaceList run() {
    FaceList faces;
    find_inner_edges();
    if (inner_.empty()) return faces;
    join_sides();
    std::vector<std::uint32_t> replaced(surface_.face_count(), kNone);  // by face: the polygon that takes its place
    std::vector<std::vector<VertexId>> polygons;
    for (const std::vector<FaceId>& piece : pieces()) {
      if (!are_triangles_of_input(piece)) continue;
      const std::vector<VertexId> outline = outline_of(piece);
      if (outline.empty()) continue;
      for (const FaceId f : piece) replaced[f.value] = static_cast<std::uint32_t>(polygons.size());
      polygons.push_back(outline);
    }
    if (polygons.empty()) return faces;
    StopCheck check(control_);
    for (std::uint32_t i = 0; i < surface_.face_count(); ++i) {
      check();
      const FaceId f(i);
      if (replaced[i] == kNone) {
        faces.add_face(surface_.face(f), surface_.face_source[f], surface_.label(f));
        continue;
      }
      std::vector<VertexId>& polygon = polygons[replaced[i]];
      if (!polygon.empty()) faces.add_face(polygon, surface_.face_source[f], surface_.label(f));
      polygon.clear();
    }
    return faces;
  }

 private:
  /// Two faces of one side at an edge inside a wall.
  struct InnerEdge {
    FaceId first, second;
    std::uint32_t half_edge, other;
  };

  Vec3 normal(FaceId f) const {
    const auto loop = surface_.face(f);
    Vec3 sum;
    for (std::size_t i = 1; i + 1 < loop.size(); ++i)
      sum += cross(surface_.local[loop[i]] - surface_.local[loop[0]],
                   surface_.local[loop[i + 1]] - surface_.local[loop[0]]);
    return sum;
  }

  /// Returns whether a face looks to the side whose faces become a polygon. All faces of one side agree, because a
  /// plane of a model contains this direction only by a rare chance.
  bool is_of_side(FaceId f) const { return dot(normal(f), {0.8414709848, 0.4546487134, 0.2920365}) > 0; }

  void find_inner_edges() {
    StopCheck check(control_);
    for (const EdgeId e : edges_.odd_edges()) {
      check();
      const auto around = edges_.half_edges(e);
      if (around.size() != 4) continue;
      std::array<std::uint32_t, 2> of_side{kNone, kNone};
      std::size_t count = 0;
      for (const std::uint32_t h : around)
        if (is_of_side(edges_.face_of(h))) {
          if (count < 2) of_side[count] = h;
          ++count;
        }
      if (count != 2 || edges_.from(of_side[0]) != edges_.to(of_side[1])) continue;
      const FaceId f = edges_.face_of(of_side[0]), g = edges_.face_of(of_side[1]);
      std::array<FaceId, 2> backs;
      std::size_t back = 0;
      for (const std::uint32_t h : around)
        if (h != of_side[0] && h != of_side[1]) backs[back++] = edges_.face_of(h);
      if (!do_lie_in_one_plane(f, g, 1) || !do_lie_in_one_plane(backs[0], backs[1], 1) ||
          !do_lie_in_one_plane(f, backs[0], -1))
        continue;
      if (!labels_.are_alike() && labels_.set_of[f.value] != labels_.set_of[g.value]) continue;
      inner_.push_back({f, g, of_side[0], of_side[1]});
    }
  }

  /// Returns whether two faces are in one plane; `sign` is 1 if they have to look the same way, and -1 if not.
  bool do_lie_in_one_plane(FaceId f, FaceId g, double sign) const {
    const auto is_near = [&](FaceId plane, FaceId corners) {
      const Vec3 n = normal(plane), origin = surface_.local[surface_.face(plane)[0]];
      const auto loop = surface_.face(corners);
      return std::all_of(loop.begin(), loop.end(), [&](VertexId v) {
        return std::fabs(dot(n, surface_.local[v] - origin)) <= tolerance_ * norm(n);
      });
    };
    return sign * dot(normal(f), normal(g)) > 0 && (is_near(f, g) || is_near(g, f));
  }

  void join_sides() {
    sides_.emplace(surface_.face_count());
    StopCheck check(control_);
    for (const InnerEdge& edge : inner_) {
      check();
      sides_->join(edge.first.value, edge.second.value);
      inside_.insert(inside_.end(), {edge.half_edge, edge.other});
    }
    sort_stoppable(inside_.begin(), inside_.end(), control_);
  }

  /// The faces of each side, ascending.
  std::vector<std::vector<FaceId>> pieces() {
    std::vector<std::pair<std::uint32_t, FaceId>> faces;
    StopCheck check(control_);
    for (const InnerEdge& edge : inner_)
      for (const FaceId f : {edge.first, edge.second}) {
        check();
        faces.push_back({sides_->find(f.value), f});
      }
    sort_unique(faces, control_);
    std::vector<std::vector<FaceId>> result;
    for (std::size_t i = 0; i < faces.size(); ++i) {
      if (i == 0 || faces[i].first != faces[i - 1].first) result.emplace_back();
      result.back().push_back(faces[i].second);
    }
    return result;
  }

  /// Output: the outline of faces; none if it is not one simple loop in a plane.
  std::vector<VertexId> outline_of(const std::vector<FaceId>& piece) const {
    std::vector<std::pair<VertexId, VertexId>> steps;
    StopCheck check(control_);
    const auto is_verbatim = [&](FaceId f) { return keep_verbatim_[surface_.face_source[f].value] != 0; };
    if (!keep_verbatim_.empty() && std::any_of(piece.begin(), piece.end(), is_verbatim)) return {};
    for (const FaceId f : piece)
      for (std::uint32_t h = surface_.face_begin[f.value]; h < surface_.face_begin[f.value + 1]; ++h) {
        check();
        if (!std::binary_search(inside_.begin(), inside_.end(), h)) steps.push_back({edges_.from(h), edges_.to(h)});
      }
    sort_stoppable(steps.begin(), steps.end(), control_);
    const auto step_from = [&](VertexId v) {
      return std::lower_bound(steps.begin(), steps.end(), std::pair(v, VertexId(0)));
    };
    for (std::size_t i = 1; i < steps.size(); ++i)
      if (steps[i].first == steps[i - 1].first) return {};
    std::vector<VertexId> loop;
    if (steps.size() < 3) return loop;
    for (VertexId v = steps[0].first; loop.empty() || v != steps[0].first;) {
      check();
      loop.push_back(v);
      const auto step = step_from(v);
      if (step == steps.end() || step->first != v || loop.size() > steps.size()) return {};
      v = step->second;
    }
    if (loop.size() != steps.size()) return {};
    std::vector<Vec3> points;
    for (const VertexId v : loop) points.push_back(surface_.local[v]);
    const PolygonSplit split = split_polygon(points, tolerance_, control_);
    if (split.kind != PolygonKind::kPlanar || split.has_spikes()) return {};
    return loop;
  }

  const Surface& surface_;
  const Adjacency& edges_;
  const BodyLabels& labels_;
  double tolerance_;
  const std::vector<std::uint8_t>& keep_verbatim_;
  std::vector<std::uint32_t> faces_of_source_;  ///< by face of the input; empty until they are counted
  RunControl& control_;
  std::vector<InnerEdge> inner_;
  std::vector<std::uint32_t> inside_;  ///< the half-edges of inner_, ascending
  std::optional<UnionFind> sides_;     ///< by face
};

}  // namespace

bool part_double_walls(Surface& surface, const Adjacency& edges, const FaceLabels& labels, double tolerance,
                       const std::vector<std::uint8_t>& keep_verbatim, RunControl& control) {
  const auto odd = edges.odd_edges();
  if (std::none_of(odd.begin(), odd.end(), [&](EdgeId e) { return edges.half_edges(e).size() == 4; })) return false;
  const BodyLabels of_faces = labels_of_sources(labels, surface.face_source.items(), control);
  FaceList faces = Walls(surface, edges, of_faces, tolerance, keep_verbatim, control).run();
  if (faces.face_count() == 0) return false;
  surface.take_faces(std::move(faces));
  return true;
}

}  // namespace remesh
