#include "core/mending/edges/holes.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/number_text.h"
#include "core/base/options.h"
#include "core/base/stoppable.h"
#include "core/geometry/intersections/self_intersections.h"
#include "core/geometry/planes/projection.h"
#include "core/geometry/trees/triangle_tree.h"
#include "core/mending/common/body_labels.h"
#include "core/mending/edges/openings.h"
#include "core/mending/polygons/polygon_split.h"

namespace remesh {
namespace {

/// The remedy for a hole that is small by itself.
constexpr std::string_view kClosedByWord = "repair=+holes closes it";

/// A hole is small by itself if its rims have at most this many edges, or are smaller than this part of the diagonal.
constexpr std::size_t kFewHoleEdges = 12;
constexpr double kSmallHole = 0.05;
/// Holes with more edges than this that are not to be closed are not tested.
constexpr std::size_t kMaxTestedEdges = 1024;
/// The max number of holes that a message names.
constexpr std::size_t kMaxNamedHoles = 20;

/// An opening, and the decision about it.
struct Hole {
  const Opening* opening;
  bool is_small = false;     ///< without regard to the options
  bool is_selected = false;  ///< the options select it to be closed
  bool is_tested = false;    ///< its triangles were searched for faces that they meet
  bool is_unknown = false;   ///< it was not found out whether its face would meet other faces
  bool is_taken = false;     ///< one of its edges belongs to another hole that can be closed
  FaceId met;                ///< a face that the face over the hole would meet elsewhere than in its rim
  std::vector<Triangle> triangles;
  Vec3 centre, normal;  ///< its plane goes through the centre
  double height = 0;    ///< max distance of the rim from this plane

  bool is_closable() const { return !triangles.empty() && !met.is_valid() && !is_unknown && !is_taken; }
};

/// Finds the faces that the faces over holes would meet.
class HoleTest {
 public:
  HoleTest(const Surface& surface, std::vector<Hole>& holes, RunControl& control)
      : surface_(surface), holes_(holes), control_(control) {}

  /// If a search for meeting faces is cut short, it is repeated without the holes whose faces are known to meet others.
  /// Holes that are still undecided after some such searches stay open, too.
  void run() {
    constexpr int kMaxSearches = 4;
    find_rims();
    for (int i = 0; i < kMaxSearches; ++i)
      if (search()) return;
    for (Hole& hole : holes_) hole.is_unknown = is_free(hole);
  }

 private:
  using RimEdge = std::tuple<std::uint32_t, VertexId, VertexId>;

  static bool is_free(const Hole& hole) { return !hole.triangles.empty() && !hole.met.is_valid(); }

  void find_rims() {
    for (std::uint32_t i = 0; i < holes_.size(); ++i) {
      const std::vector<VertexId>& outline = holes_[i].opening->outline;
      if (holes_[i].triangles.empty()) continue;
      for (std::size_t k = 0; k < outline.size(); ++k) {
        const VertexId v = outline[k], w = outline[k + 1 == outline.size() ? 0 : k + 1];
        rim_edges_.push_back({i, std::min(v, w), std::max(v, w)});
        rim_vertices_.emplace_back(i, v);
      }
    }
    sort_stoppable(rim_edges_.begin(), rim_edges_.end(), control_);
    sort_stoppable(rim_vertices_.begin(), rim_vertices_.end(), control_);
  }

  /// Searches for the faces that meet the faces over undecided holes.
  /// Output: whether all holes are decided then.
  bool search() {
    std::vector<Triangle> triangles;
    std::vector<std::uint32_t> hole_of;
    for (std::uint32_t i = 0; i < holes_.size(); ++i) {
      if (!is_free(holes_[i])) continue;
      triangles.insert(triangles.end(), holes_[i].triangles.begin(), holes_[i].triangles.end());
      hole_of.resize(triangles.size(), i);
    }
    if (triangles.empty()) return true;
    const std::size_t over_holes = triangles.size();
    const std::vector<FaceId> near = near_faces(triangles, hole_of);
    std::vector<FaceId> face_of;
    for (const FaceId f : near)
      visit_triangles(surface_, f, control_, [&](const Triangle& t) {
        triangles.push_back(t);
        face_of.push_back(f);
      });
    std::vector<std::uint32_t> pieces(over_holes, kNoPiece);
    pieces.resize(triangles.size(), 0);
    const SearchLimits limits(SearchLimits::kEnoughPairs, SearchLimits::steps_for(triangles.size()));
    const SelfIntersections found = self_intersections(surface_.local.items(), triangles, pieces, limits, control_);
    // Where two faces over holes meet, one of them meets a face at the rim of the other one.
    for (const auto& [f, g] : found.pairs)
      if (f.value < over_holes && g.value >= over_holes) {
        FaceId& met = holes_[hole_of[f.value]].met;
        met = std::min(met, face_of[g.value - over_holes]);
      }
    return found.is_complete;
  }

  /// Returns the faces that are near the triangles over holes and may meet them. These are all faces if boxes tell too
  /// few of them apart, as in a stack of sheets that are askew to the axes.
  std::vector<FaceId> near_faces(const std::vector<Triangle>& triangles, const std::vector<std::uint32_t>& hole_of) {
    constexpr std::size_t kFacesPerBlock = 4096, kMaxLooksPerFace = 256;
    const std::size_t most_looks = kMaxLooksPerFace * (surface_.face_count() + kFacesPerBlock);
    std::atomic<std::size_t> looks{0};
    const auto are_too_many = [&] { return looks.load(std::memory_order_relaxed) > most_looks; };
    const TriangleTree tree(surface_.local.items(), triangles, control_, hole_of);
    const auto hole_of_slot = [&](std::size_t slot) { return hole_of[tree.face(slot).value]; };
    const auto only = [](std::uint32_t a, std::uint32_t b) { return a == b ? a : kNone; };
    const std::vector<std::uint32_t> hole_of_node = tree.joined<std::uint32_t>(hole_of_slot, only, control_);
    const auto is_near_a_hole = [&](std::size_t f) {
      const auto corners = surface_.face(FaceId(f));
      Box3 box;
      for (const VertexId v : corners) box.add(surface_.local[v]);
      std::uint32_t last = kNone;
      bool is_last_clear = false, is_near = false;
      const auto is_clear = [&](std::uint32_t hole) {
        if (hole == kNone) return false;
        if (hole != last) is_last_clear = is_clear_of(corners, hole);
        last = hole;
        return is_last_clear;
      };
      std::size_t looks_here = 0;
      const auto look = [&] {
        if (++looks_here % kFacesPerBlock == 0) control_.check_and_move();
      };
      tree.visit_meeting(
          box, 0,
          [&](std::size_t node) {
            look();
            return is_clear(hole_of_node[node]);
          },
          [&](std::size_t slot) {
            look();
            is_near = !is_clear(hole_of_slot(slot));
            return !is_near && looks_here <= most_looks;
          });
      looks.fetch_add(looks_here, std::memory_order_relaxed);
      return is_near;
    };
    auto near = select_ids<FaceId>(surface_.face_count(), kFacesPerBlock, control_,
                                   [&](std::size_t f) { return are_too_many() || is_near_a_hole(f); });
    // The order in which faces are looked at does not decide whether there are too many looks.
    if (are_too_many())
      near = select_ids<FaceId>(surface_.face_count(), kFacesPerBlock, control_, [](std::size_t) { return true; });
    return near;
  }

  /// Returns whether a face is clearly apart from the plane of a hole, or stands on an edge or a vertex of the hole's
  /// rim and is apart from the plane elsewhere.
  bool is_clear_of(std::span<const VertexId> corners, std::uint32_t hole) const {
    constexpr double kRounding = 0x1p-45;  // of coordinates up to 1
    const Hole& of = holes_[hole];
    std::size_t above = 0, below = 0;
    VertexId on_plane[2];
    std::size_t count = 0;
    for (const VertexId v : corners) {
      const double height = dot(surface_.local[v] - of.centre, of.normal);
      if (height > of.height + kRounding) {
        ++above;
      } else if (height < -of.height - kRounding) {
        ++below;
      } else {
        if (count == 2) return false;
        on_plane[count++] = v;
      }
    }
    if (above != 0 && below != 0) return false;
    if (count == 0) return true;
    if (count == 1) return std::binary_search(rim_vertices_.begin(), rim_vertices_.end(), std::pair(hole, on_plane[0]));
    const auto [v, w] = std::minmax(on_plane[0], on_plane[1]);
    return std::binary_search(rim_edges_.begin(), rim_edges_.end(), RimEdge{hole, v, w});
  }

  const Surface& surface_;
  std::vector<Hole>& holes_;
  RunControl& control_;
  std::vector<RimEdge> rim_edges_;  ///< sorted, as the vertices are
  std::vector<std::pair<std::uint32_t, VertexId>> rim_vertices_;
};

/// A length or a coordinate as messages have it.
std::string short_text(double x) { return number_text(x, 4); }

class Closing {
 public:
  Closing(Surface& surface, const Adjacency& edges, const FaceLabels& labels, const HoleRules& rules,
          RunControl& control)
      : surface_(surface), edges_(edges), labels_(labels), rules_(rules), control_(control) {}

  bool run(std::vector<Diagnostic>& diagnostics, Advice& left) {
    const double tolerance = rules_.plane_tolerance / surface_.unit;
    const std::vector<Opening> openings = find_openings(surface_, edges_, tolerance, control_);
    for (const Opening& opening : openings) {
      Hole& hole = holes_.emplace_back();
      hole.opening = &opening;
      const auto do_all_rims = [&](const auto& holds) {
        return std::all_of(opening.rims.begin(), opening.rims.end(), holds);
      };
      hole.is_small = do_all_rims([&](const Rim& rim) { return is_small(rim); });
      hole.is_selected = rules_.mend == MendMode::kYes && do_all_rims([&](const Rim& rim) { return is_selected(rim); });
    }
    if (does_it_matter_what_is_closable())
      for (Hole& hole : holes_) split(hole, tolerance);
    HoleTest(surface_, holes_, control_).run();
    give_edges_to_holes();
    std::vector<const Hole*> closed;
    for (const Hole& hole : holes_)
      if (hole.is_selected && hole.is_closable()) closed.push_back(&hole);
    left = describe_left();
    if (closed.empty()) return false;
    close(closed, diagnostics);
    return true;
  }

 private:
  double size_of(const Rim& rim) const { return rim.size * surface_.unit; }
  bool is_small(const Rim& rim) const {
    return rim.vertices.size() <= kFewHoleEdges || size_of(rim) < kSmallHole * rules_.diagonal;
  }
  bool is_selected(const Rim& rim) const {
    if (!rules_.max_edges && !(rules_.size > 0)) return is_small(rim);
    return (rules_.max_edges && rim.vertices.size() <= *rules_.max_edges) || size_of(rim) < rules_.size;
  }

  /// Returns whether some hole may be closed or named, or two flat ones may share an edge. Otherwise the holes are only
  /// counted, as for a sheet with a long rim.
  bool does_it_matter_what_is_closable() const {
    std::optional<std::uint32_t> depth;
    for (const Hole& hole : holes_) {
      if (hole.is_small || hole.is_selected) return true;
      if (hole.opening->kind != OpeningKind::kFlat) continue;
      if (depth.value_or(hole.opening->depth) != hole.opening->depth) return true;
      depth = hole.opening->depth;
    }
    return false;
  }

  /// Makes the triangles of the face over a hole, if the hole has to be tested.
  void split(Hole& hole, double tolerance) const {
    const std::vector<VertexId>& outline = hole.opening->outline;
    if (hole.opening->kind != OpeningKind::kFlat) return;
    if (rules_.mend == MendMode::kNo && outline.size() > kMaxTestedEdges) return;
    hole.is_tested = true;
    std::vector<Vec3> points;
    for (const VertexId v : outline) {
      points.push_back(surface_.local[v]);
      hole.centre += (1.0 / static_cast<double>(outline.size())) * points.back();
    }
    hole.normal = normalized(newell_normal(points));
    for (const Vec3& p : points) hole.height = std::max(hole.height, std::fabs(dot(p - hole.centre, hole.normal)));
    PolygonSplit triangles;
    if (points.size() == 3)
      triangles.triangles = {{0, 1, 2}};
    else
      triangles = split_polygon(points, {2 * tolerance, 0}, control_);
    if (triangles.kind != PolygonKind::kPlanar || triangles.has_spikes()) return;
    for (const auto& [a, b, c] : triangles.triangles) hole.triangles.push_back({outline[a], outline[b], outline[c]});
  }

  /// Decides which of two holes that share an edge gets the edge, if faces could close either. The outer hole gets it.
  /// For example, a pipe with a thick wall is open between its rims, and not across its bore.
  void give_edges_to_holes() {
    std::vector<Hole*> by_depth;
    for (Hole& hole : holes_)
      if (hole.is_closable()) by_depth.push_back(&hole);
    std::stable_sort(by_depth.begin(), by_depth.end(),
                     [](const Hole* a, const Hole* b) { return a->opening->depth < b->opening->depth; });
    if (by_depth.empty()) return;
    is_given_.assign(edges_.edge_count(), 0);
    StopCheck check(control_);
    for (Hole* hole : by_depth) {
      hole->is_taken = has_given_edge(*hole);
      if (hole->is_taken) continue;
      for (const Rim& rim : hole->opening->rims)
        for (std::size_t i = 0; i < rim.vertices.size(); ++i) {
          check();
          is_given_[edge_at(rim, i).value] = 1;
        }
    }
  }
  bool has_given_edge(const Hole& hole) const {
    return std::any_of(hole.opening->rims.begin(), hole.opening->rims.end(),
                       [&](const Rim& rim) { return has_given_edge(rim); });
  }
  bool has_given_edge(const Rim& rim) const {
    if (is_given_.empty()) return false;
    for (std::size_t i = 0; i < rim.vertices.size(); ++i)
      if (is_given_[edge_at(rim, i).value] != 0) return true;
    return false;
  }

  EdgeId edge_at(const Rim& rim, std::size_t i) const {
    return edges_.find(rim.vertices[i], rim.vertices[i + 1 == rim.vertices.size() ? 0 : i + 1]);
  }
  /// The face of the surface beside an edge of a rim.
  FaceId face_at(const Rim& rim, std::size_t i) const {
    return edges_.face_of(edges_.half_edges(edge_at(rim, i)).front());
  }
  double length_at(const Rim& rim, std::size_t i) const {
    const VertexId v = rim.vertices[i], w = rim.vertices[i + 1 == rim.vertices.size() ? 0 : i + 1];
    return norm(surface_.local[w] - surface_.local[v]);
  }

  /// The face whose labels and source the face over a hole gets. Of all labels at the rims, those along the largest
  /// length win; of the faces with these labels, the one at the longest edge wins. The first one along the rims decides
  /// between equals.
  FaceId model_face(const Hole& hole, const IdVector<FaceId, std::uint32_t>& label) const {
    struct Share {
      double length = 0, longest = 0;
      FaceId face;
    };
    std::map<std::uint32_t, Share> shares;
    std::vector<std::uint32_t> order;  // in which labels were met
    for (const Rim& rim : hole.opening->rims)
      for (std::size_t i = 0; i < rim.vertices.size(); ++i) {
        const FaceId face = face_at(rim, i);
        const std::uint32_t number = label.empty() ? 0 : label[surface_.face_source[face]];
        const auto [entry, is_new] = shares.try_emplace(number);
        if (is_new) order.push_back(number);
        const double length = length_at(rim, i);
        entry->second.length += length;
        if (!(length > entry->second.longest)) continue;
        entry->second.longest = length;
        entry->second.face = face;
      }
    const auto most = std::max_element(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return shares[a].length < shares[b].length;
    });
    return shares[*most].face;
  }

  void close(const std::vector<const Hole*>& closed, std::vector<Diagnostic>& diagnostics) {
    const IdVector<FaceId, std::uint32_t> label =
        number_labels(labels_, {true, true, true}, count_of_labels(), control_);
    struct Cap {
      FaceId source;
      std::uint32_t label;
      const Hole* hole;
    };
    std::vector<Cap> caps;
    Diagnostic told{DiagnosticCode::kClosedHole, 0, {}, "holes were closed by flat faces: " + list(closed, {})};
    for (const Hole* hole : closed) {
      control_.check();
      const FaceId face = model_face(*hole, label);
      caps.push_back({surface_.face_source[face], surface_.label(face), hole});
      told.add(surface_.face_source[face].value);
    }
    told.message += "; `elements` lists for each hole a face at its rim, whose labels the new face has";
    diagnostics.push_back(std::move(told));
    std::stable_sort(caps.begin(), caps.end(), [](const Cap& a, const Cap& b) { return a.source < b.source; });
    FaceList faces;
    std::vector<FaceId> new_faces;
    auto next = caps.begin();
    const auto add_until = [&](FaceId source) {
      for (; next != caps.end() && next->source < source; ++next) {
        new_faces.push_back(FaceId(faces.face_count()));
        faces.add_face(next->hole->opening->outline, next->source, next->label);
      }
    };
    StopCheck check(control_);
    for (FaceId f(0); f.value < surface_.face_count(); ++f.value) {
      check();
      add_until(surface_.face_source[f]);
      faces.add_face(surface_.face(f), surface_.face_source[f], surface_.label(f));
    }
    add_until(FaceId());
    surface_.take_faces(std::move(faces));
    surface_.caps = std::move(new_faces);
  }

  std::size_t count_of_labels() const {
    return std::max({labels_.object.of_face.size(), labels_.group.of_face.size(), labels_.material.of_face.size()});
  }

  /// The rims of a hole, except those whose other side belongs to another hole that can be closed.
  std::vector<const Rim*> own_rims(const Hole& hole) const {
    std::vector<const Rim*> rims;
    for (const Rim& rim : hole.opening->rims)
      if (hole.is_closable() || !has_given_edge(rim)) rims.push_back(&rim);
    return rims;
  }

  /// Describes a hole: its edges, size and place.
  std::string describe(const Hole& hole) const {
    std::string text;
    const std::vector<const Rim*> rims = own_rims(hole);
    for (const Rim* rim : rims) text += (text.empty() ? "" : " and ") + std::to_string(rim->vertices.size());
    const Rim& outer = *rims.front();
    const Vec3 at = surface_.centre + surface_.unit * outer.middle;
    const auto coordinate = [&](double x) {
      constexpr double kNothing = 1e-6;  // of the diagonal
      return short_text(std::fabs(x) <= kNothing * rules_.diagonal ? 0 : x);
    };
    return text + " edges, size " + short_text(size_of(outer)) + ", perimeter " +
           short_text(outer.length * surface_.unit) + ", around (" + coordinate(at.x) + ", " + coordinate(at.y) + ", " +
           coordinate(at.z) + ")";
  }

  /// Lists the first holes, each with its text in `words`.
  std::string list(const std::vector<const Hole*>& holes, const std::vector<std::string>& words) const {
    std::string text;
    for (std::size_t i = 0; i < std::min(holes.size(), kMaxNamedHoles); ++i)
      text += (i == 0 ? "" : "; ") + describe(*holes[i]) + (words.empty() ? "" : ": " + words[i]);
    if (holes.size() > kMaxNamedHoles) text += "; and " + std::to_string(holes.size() - kMaxNamedHoles) + " more";
    return text;
  }

  /// Returns the option that closes a hole that stays open, or the reason why no option does.
  std::string remedy(const Hole& hole) const {
    switch (hole.opening->kind) {
      case OpeningKind::kNotFlat: return "no option closes it, because it lies in no plane";
      case OpeningKind::kWithoutArea: return "no option closes it, because it has no width";
      case OpeningKind::kTangled: return "no option closes it, because it crosses or touches itself or another loop";
      case OpeningKind::kMixed:
        return "no option closes it, because the faces around that part of the plane do not look the same way";
      case OpeningKind::kNoBridge:
        return "no option closes it, because other faces have the edges that would join its loops";
      case OpeningKind::kFlat: break;
    }
    if (hole.met.is_valid())
      return "no option closes it, because a flat face over it would meet face " +
             std::to_string(surface_.face_source[hole.met].value);
    if (hole.is_unknown)
      return "not closed, because so many faces meet here that it was not found out whether a flat face over it would";
    if (hole.is_tested && hole.triangles.empty()) return "no option closes it, because it touches itself";
    if (rules_.mend == MendMode::kNo && hole.is_small) return std::string(kClosedByWord);
    return "repair=+holes with max_hole_edges=" + std::to_string(most_edges(hole)) + " closes it";
  }

  static std::size_t most_edges(const Hole& hole) {
    std::size_t most = 0;
    for (const Rim& rim : hole.opening->rims) most = std::max(most, rim.vertices.size());
    return most;
  }

  /// Describes the holes that stay open.
  Advice describe_left() const {
    std::vector<const Hole*> named;
    std::vector<std::string> remedies;
    std::size_t larger = 0, edges_of_larger = 0;
    for (const Hole& hole : holes_) {
      const std::vector<const Rim*> rims = own_rims(hole);
      if ((hole.is_selected && hole.is_closable()) || rims.empty()) continue;
      const bool are_small = std::all_of(rims.begin(), rims.end(), [&](const Rim* rim) { return is_small(*rim); });
      if (are_small || hole.is_selected) {
        named.push_back(&hole);
        remedies.push_back(named.size() <= kMaxNamedHoles ? remedy(hole) : std::string());
      } else if (hole.opening->kind == OpeningKind::kFlat) {
        ++larger;
        edges_of_larger = std::max(edges_of_larger, most_edges(hole));
      }
    }
    Advice left;
    std::string& text = left.text;
    if (std::find(remedies.begin(), remedies.end(), kClosedByWord) != remedies.end())
      left.remedies.push_back({"repair=+holes", "would close small holes"});
    if (larger > 0)
      left.remedies.push_back(
          {"repair=+holes&max_hole_edges=" + std::to_string(edges_of_larger), "would close flat holes"});
    if (!named.empty()) text = "; loops of these edges: " + list(named, remedies);
    if (larger > 0)
      text += "; " + std::to_string(larger) + " larger " + (larger == 1 ? "loop is" : "loops are") +
              " flat, and repair=+holes with max_hole_edges=" + std::to_string(edges_of_larger) +
              " closes what no other face meets";
    return left;
  }

  Surface& surface_;
  const Adjacency& edges_;
  const FaceLabels& labels_;
  const HoleRules& rules_;
  RunControl& control_;
  std::vector<Hole> holes_;
  std::vector<std::uint8_t> is_given_;  ///< for each edge, whether a hole that can be closed has it; empty if none is
};

}  // namespace

bool close_holes(Surface& surface, const Adjacency& edges, const FaceLabels& labels, const HoleRules& rules,
                 std::vector<Diagnostic>& diagnostics, Advice& left, RunControl& control) {
  if (edges.odd_edges().empty()) return false;
  return Closing(surface, edges, labels, rules, control).run(diagnostics, left);
}

}  // namespace remesh
