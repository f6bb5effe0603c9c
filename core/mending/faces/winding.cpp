#include "core/mending/faces/winding.h"

#include <algorithm>
#include <array>
#include <tuple>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"
#include "core/geometry/shells/inside_out.h"
#include "core/mending/common/body_labels.h"
#include "core/mending/polygons/triangulated.h"
#include "core/mesh/face_geometry.h"
#include "core/mesh/triangle_corners.h"

namespace remesh {
namespace {

/// Returns the first half-edge of each edge whose two faces have opposite orientations.
std::vector<std::uint32_t> inconsistent_edges(const Adjacency& edges, RunControl& control) {
  std::vector<std::uint32_t> first;
  StopCheck check(control);
  for (const EdgeId e : edges.odd_edges()) {
    check();
    const auto around = edges.half_edges(e);
    if (around.size() == 2 && edges.from(around[0]) != edges.to(around[0])) first.push_back(around[0]);
  }
  return first;
}

double area(const Surface& surface, FaceId f) {
  const auto loop = surface.face(f);
  const Vec3 origin = surface.local[loop[0]];
  Vec3 twice_area;
  for (std::size_t i = 1; i + 1 < loop.size(); ++i)
    twice_area += cross(surface.local[loop[i]] - origin, surface.local[loop[i + 1]] - origin);
  return norm(twice_area) / 2;
}

void turn_over(Surface& surface, const std::vector<std::uint8_t>& is_turned, RunControl& control) {
  if (std::none_of(is_turned.begin(), is_turned.end(), [](std::uint8_t is) { return is != 0; })) return;
  surface.corners.change([&](std::vector<VertexId>& corners) {
    StopCheck check(control);
    for (std::uint32_t f = 0; f < surface.face_count(); ++f) {
      check();
      if (is_turned[f]) std::reverse(&corners[surface.face_begin[f]], corners.data() + surface.face_begin[f + 1]);
    }
  });
}

class Unifying {
 public:
  Unifying(const Surface& surface, const Adjacency& edges, RunControl& control)
      : surface_(surface), edges_(edges), control_(control), side_(surface.face_count(), kUnknown) {}

  /// Gives each piece that has one of these edges a consistent winding.
  void run(const std::vector<std::uint32_t>& inconsistent) {
    is_turned.assign(surface_.face_count(), 0);
    for (const std::uint32_t h : inconsistent) {
      const FaceId seed = edges_.face_of(h);
      if (side_[seed.value] != kUnknown) continue;
      if (walk(seed))
        turn_one_side();
      else
        one_sided.push_back(*std::min_element(piece_.begin(), piece_.end()));
    }
  }

  /// Turns the closed pieces among those that were wound, so that `is_wrong` holds for none of their faces.
  void correct(const std::vector<std::uint8_t>& is_wrong) {
    StopCheck check(control_);
    for (const std::vector<FaceId>& piece : closed) {
      if (is_wrong[piece[0].value] == 0) continue;
      for (const FaceId f : piece) {
        check();
        is_turned[f.value] ^= 1;
      }
    }
  }

  std::vector<std::uint8_t> is_turned;
  std::vector<FaceId> one_sided;            ///< the first face of each piece that cannot be wound consistently
  std::vector<std::vector<FaceId>> closed;  ///< the closed pieces that were wound; each encloses a positive volume

 private:
  static constexpr std::uint8_t kUnknown = 2;

  /// Gives every face of a piece its side. The seed has side 0. Output: whether the sides are consistent.
  bool walk(FaceId seed) {
    bool is_possible = true;
    piece_.assign(1, seed);
    side_[seed.value] = 0;
    for (std::size_t i = 0; i < piece_.size(); ++i) {
      if (i % 4096 == 0) control_.check_and_move();
      const FaceId f = piece_[i];
      for (std::uint32_t h = surface_.face_begin[f.value]; h < surface_.face_begin[f.value + 1]; ++h) {
        const std::uint32_t other = other_of_two(h);
        if (other == kNone) continue;
        const bool is_opposite = edges_.from(other) == edges_.from(h);
        const std::uint8_t side = side_[f.value] ^ static_cast<std::uint8_t>(is_opposite);
        const FaceId g = edges_.face_of(other);
        if (side_[g.value] == kUnknown) {
          side_[g.value] = side;
          piece_.push_back(g);
        } else if (side_[g.value] != side) {
          is_possible = false;
        }
      }
    }
    return is_possible;
  }

  /// Returns the other half-edge of an edge with two faces, whatever their orientations are.
  std::uint32_t other_of_two(std::uint32_t h) const {
    if (const std::uint32_t twin = edges_.twin(h); twin != kNone) return twin;
    const auto around = edges_.half_edges(edges_.edge_of(h));
    if (around.size() != 2 || edges_.from(h) == edges_.to(h)) return kNone;
    return around[0] == h ? around[1] : around[0];
  }

  /// Turns the side with which the piece would enclose a negative volume. If the piece is open, the smaller side turns.
  void turn_one_side() {
    struct Side {
      double area = 0;
      std::size_t faces = 0;
      Vec3 place{HUGE_VAL, HUGE_VAL, HUGE_VAL};  ///< decides ties, independently of the input's order
    };
    std::array<Side, 2> sides;
    double volume = 0;  // six times that of side 0, with the other side turned
    const Vec3 origin = surface_.local[surface_.face(piece_[0])[0]];
    StopCheck check(control_);
    for (const FaceId f : piece_) {
      check();
      Side& side = sides[side_[f.value]];
      side.area += area(surface_, f);
      ++side.faces;
      Vec3 sum;
      for (const VertexId v : surface_.face(f)) sum += surface_.local[v];
      side.place = std::min(side.place, (1.0 / static_cast<double>(surface_.face(f).size())) * sum);
      volume += (side_[f.value] == 0 ? 1 : -1) * six_volumes_below(surface_, f, origin);
    }
    const auto is_smaller = [&](const Side& a, const Side& b) {
      return std::tuple(a.area, a.faces, b.place) < std::tuple(b.area, b.faces, a.place);
    };
    std::uint8_t turned = is_smaller(sides[0], sides[1]) ? 0 : 1;
    // A doubled sheet encloses nothing but rounding errors.
    constexpr double kClearly = 1e-9;
    const double total = sides[0].area + sides[1].area;
    if (std::fabs(volume) > kClearly * total * std::sqrt(total) && is_piece_closed()) {
      turned = volume > 0 ? 1 : 0;
      closed.push_back(piece_);
    }
    for (const FaceId f : piece_) {
      check();
      is_turned[f.value] = side_[f.value] == turned;
    }
  }

  /// Returns whether the piece has an even number of faces at each of its edges.
  bool is_piece_closed() const {
    std::vector<EdgeId> odd;
    StopCheck check(control_);
    for (const FaceId f : piece_)
      for (std::uint32_t h = surface_.face_begin[f.value]; h < surface_.face_begin[f.value + 1]; ++h) {
        check();
        if (other_of_two(h) == kNone && edges_.from(h) != edges_.to(h)) odd.push_back(edges_.edge_of(h));
      }
    sort_stoppable(odd.begin(), odd.end(), control_);
    for (std::size_t begin = 0, end = 0; begin < odd.size(); begin = end) {
      while (end < odd.size() && odd[end] == odd[begin]) ++end;
      if ((end - begin) % 2 != 0) return false;
    }
    return true;
  }

  const Surface& surface_;
  const Adjacency& edges_;
  RunControl& control_;
  std::vector<std::uint8_t> side_;
  std::vector<FaceId> piece_;
};

}  // namespace

InsideOutFaces find_inside_out_faces(const Surface& surface, const Adjacency& edges, const FaceLabels& labels,
                                     RunControl& control) {
  const Triangulated triangles(surface, control);
  const auto& positions = surface.local.items();
  if (!triangles.are_split()) {
    const BodyLabels of_faces = labels_of_sources(labels, surface.face_source.items(), control);
    InsideOut found = find_inside_out(positions, triangles.corners(), edges, of_faces, control);
    return {std::move(found.is_inside_out), std::move(found.first_faces)};
  }
  std::vector<FaceId> source;
  for (std::size_t t = 0; t < triangles.size(); ++t) source.push_back(surface.face_source[triangles.face(t)]);
  const BodyLabels of_triangles = labels_of_sources(labels, source, control);
  const std::vector<std::uint32_t> begins = triangle_begins(triangles.size(), control);
  const Adjacency own_edges(surface.vertex_count(), begins, triangles.corners(), control);
  const InsideOut found = find_inside_out(positions, triangles.corners(), own_edges, of_triangles, control);
  InsideOutFaces result;
  if (found.first_faces.empty()) return result;
  for (const FaceId t : found.first_faces) result.first.push_back(triangles.face(t.value));
  result.is_inside_out.resize(surface.face_count());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    result.is_inside_out[triangles.face(t).value] |= found.is_inside_out[t];
  return result;
}

bool unify_winding(Surface& surface, const Adjacency& edges, const FaceLabels& labels, MendMode mend,
                   std::vector<Diagnostic>& diagnostics, RunControl& control) {
  const std::vector<std::uint32_t> inconsistent = inconsistent_edges(edges, control);
  if (inconsistent.empty()) return false;
  if (mend == MendMode::kNo) {
    Diagnostic found{
        DiagnosticCode::kInconsistentWinding,
        0,
        {},
        "edges have two faces with opposite orientations; `elements` lists the first face of each edge by number"};
    for (const std::uint32_t h : inconsistent) found.add(surface.face_source[edges.face_of(h)].value);
    diagnostics.push_back(std::move(found));
    return false;
  }
  Unifying unifying(surface, edges, control);
  unifying.run(inconsistent);
  if (!unifying.closed.empty()) {
    Surface wound = surface;
    turn_over(wound, unifying.is_turned, control);
    const Adjacency own_edges(wound.vertex_count(), wound.face_begin, wound.corners, control);
    const InsideOutFaces found = find_inside_out_faces(wound, own_edges, labels, control);
    if (!found.first.empty()) unifying.correct(found.is_inside_out);
  }
  Diagnostic turned{DiagnosticCode::kInconsistentWinding,
                    0,
                    {},
                    "faces were turned over to have the same orientation as their neighbours"};
  if (!unifying.closed.empty())
    turned.message +=
        "; closed shells whose faces disagreed now enclose a positive volume, or as cavities a negative one";
  Diagnostic left{DiagnosticCode::kInconsistentWinding,
                  0,
                  {},
                  "pieces of the surface are one-sided, like a Moebius strip, and were left as they were; `elements` "
                  "lists the first face of each piece by number"};
  const auto turned_faces = select_ids<FaceId>(surface.face_count(), kItemsPerBlock, control,
                                               [&](std::size_t f) { return unifying.is_turned[f] != 0; });
  surface.for_each_source(turned_faces, [&](FaceId source) { turned.add(source.value); });
  for (const FaceId f : unifying.one_sided) left.add(surface.face_source[f].value);
  turn_over(surface, unifying.is_turned, control);
  const bool is_changed = turned.count > 0;
  for (Diagnostic* d : {&turned, &left})
    if (d->count > 0) diagnostics.push_back(std::move(*d));
  return is_changed;
}

bool turn_inside_out(Surface& surface, const Adjacency& edges, const FaceLabels& labels, MendMode mend,
                     std::vector<Diagnostic>& diagnostics, RunControl& control) {
  const InsideOutFaces found = find_inside_out_faces(surface, edges, labels, control);
  if (found.first.empty()) return false;
  Diagnostic inside_out{DiagnosticCode::kInsideOut, 0, {}, ""};
  inside_out.message =
      std::string(
          "closed shells have the wrong orientation: bodies that enclose a negative volume, or cavities that enclose a "
          "positive volume in a body of the same object, group and material") +
      (mend == MendMode::kYes ? "; they were turned over" : "") +
      "; `elements` lists the first face of each shell by number";
  for (const FaceId f : found.first) inside_out.add(surface.face_source[f].value);
  if (mend == MendMode::kNo) inside_out.remedies.push_back({"repair=+inside_out", "would turn these shells over"});
  diagnostics.push_back(std::move(inside_out));
  if (mend == MendMode::kNo) return false;
  turn_over(surface, found.is_inside_out, control);
  return true;
}

}  // namespace remesh
