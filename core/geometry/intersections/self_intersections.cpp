#include "core/geometry/intersections/self_intersections.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <tuple>

#include "core/base/stoppable.h"
#include "core/geometry/exact/predicates_3d.h"
#include "core/geometry/intersections/axial_bounds.h"
#include "core/geometry/intersections/half_planes.h"
#include "core/geometry/intersections/pair_search.h"
#include "core/geometry/trees/triangle_tree.h"
#include "core/geometry/triangles/triangle_intersection.h"

namespace remesh {
namespace {

/// The number of faces between two checks for cancellation.
constexpr std::size_t kFacesBetweenChecks = 4096;

constexpr std::size_t kFacesPerTask = 256;

/// A vertex with more faces than this is a hub. The pairs around it are found by their directions from it.
constexpr std::uint32_t kMaxAtVertex = 64;

/// Directions are rounded, so their boxes are widened by this.
constexpr double kDirectionMargin = 1e-12;

/// A triangle whose box contains the whole sphere of directions. The triangle itself does not contain it.
constexpr std::array kWholeSphere{Vec3{-1, -1, -1}, Vec3{1, 1, 1}, Vec3{1, 1, 1}};

/// The hubs that a face has, that two faces share, or that all faces of a node have. They are different and ascending.
/// If there are fewer than three, invalid ids follow.
using Hubs = std::array<VertexId, 3>;

bool has(const Triangle& face, VertexId v) { return std::find(face.begin(), face.end(), v) != face.end(); }

template <class IsOne>
Hubs select(const Hubs& hubs, const IsOne& is_one) {
  Hubs selected;
  std::copy_if(hubs.begin(), hubs.end(), selected.begin(), [&](VertexId v) { return v.is_valid() && is_one(v); });
  return selected;
}

Hubs common(const Hubs& a, const Hubs& b) {
  return select(a, [&](VertexId v) { return std::find(b.begin(), b.end(), v) != b.end(); });
}

/// An edge between two hubs, in ascending order.
using HubEdge = std::pair<VertexId, VertexId>;
constexpr HubEdge kNoEdge{};

/// Speeds up searches in which boxes separate too few faces. For a slot with hubs, nodes that lie at other angles about
/// an edge between hubs are of no interest.
class AxialSearch {
 public:
  /// Input:   edge_of(slot) is an edge at the slot's face, or kNoEdge. `faces` are the triangles of the tree, by their
  ///          numbers in it.
  /// Output:  whether any of the slots has such an edge.
  template <class EdgeOf>
  bool prepare(const TriangleTree& tree, std::span<const Vec3> positions, std::span<const Triangle> faces,
               std::span<const std::uint32_t> slots, const EdgeOf& edge_of, RunControl& control) {
    std::vector<std::pair<HubEdge, std::uint32_t>> at_edge;
    StopCheck check(control);
    for (const std::uint32_t slot : slots) {
      check();
      if (const HubEdge edge = edge_of(slot); edge != kNoEdge) at_edge.push_back({edge, slot});
    }
    sort_stoppable(at_edge.begin(), at_edge.end(), control);
    of_slot_.resize(tree.size());
    std::vector<std::pair<std::size_t, std::size_t>> ranges;  // in `at_edge`, one for each edge
    for (std::size_t begin = 0, end = 0; begin < at_edge.size(); begin = end) {
      check();
      while (end < at_edge.size() && at_edge[end].first == at_edge[begin].first) ++end;
      // To test all pairs of a few slots takes less time than to compute the bounds of all nodes.
      if ((end - begin) * (end - begin) >= tree.size()) ranges.push_back({begin, end});
    }
    // The bounds about an edge take some bytes for each node of the tree. So only the edges with the most slots get
    // any.
    constexpr std::size_t kMaxEdges = 32;
    std::stable_sort(ranges.begin(), ranges.end(),
                     [](const auto& a, const auto& b) { return a.second - a.first > b.second - b.first; });
    ranges.resize(std::min(ranges.size(), kMaxEdges));
    for (const auto& [begin, end] : ranges) {
      const HubEdge edge = at_edge[begin].first;
      bounds_.emplace_back(tree, positions, faces, edge.first, edge.second, control);
      for (std::size_t i = begin; i < end; ++i) {
        check();
        const std::uint32_t slot = at_edge[i].second;
        of_slot_[slot] = {static_cast<std::uint32_t>(bounds_.size()),
                          bounds_.back().arc_of(faces[tree.face(slot).value])};
      }
    }
    return !bounds_.empty();
  }

  bool are_apart(std::size_t slot, std::size_t node) const {
    if (bounds_.empty() || of_slot_[slot].bounds == 0) return false;
    return bounds_[of_slot_[slot].bounds - 1].are_apart(of_slot_[slot].arc, node);
  }

 private:
  struct Seen {
    std::uint32_t bounds = 0;  ///< index into `bounds_` plus 1; 0 if there are none
    AxialBounds::Arc arc;
  };
  std::vector<AxialBounds> bounds_;
  std::vector<Seen> of_slot_;
};

class Search {
 public:
  Search(std::span<const Vec3> positions, std::span<const Triangle> faces, std::span<const std::uint32_t> pieces,
         const SearchLimits& limits, RunControl& control)
      : positions_(scaled_for_predicates(positions, control)),
        faces_(faces),
        pieces_(pieces),
        control_(control),
        search_(limits, control) {}

  SelfIntersections run() {
    find_hubs();
    std::size_t done = find_everywhere();
    done += find_at_edges();
    for (std::size_t begin = 0; begin < at_hub_.size() && search_.goes_on();) {
      control_.check();
      std::size_t end = begin + 1;
      while (end < at_hub_.size() && at_hub_[end].first == at_hub_[begin].first) ++end;
      done += find_at_hub(begin, end);
      begin = end;
    }
    SelfIntersections& result = search_.result();
    if (!result.is_complete) {
      const std::size_t all = faces_.size() + at_edge_.size() + at_hub_.size();
      result.searched = static_cast<double>(done) / static_cast<double>(all);
      result.pairs.resize(std::min(result.pairs.size(), search_.limits().max_pairs));
    }
    sort_unique(result.pairs, control_);
    return std::move(result);
  }

 private:
  /// An edge between two hubs (vertices with very many faces), and how many faces have it.
  struct AtEdge {
    HubEdge edge = kNoEdge;
    std::uint32_t faces = 0;
    bool is_own = false;  ///< whether it is an edge of the face in question
  };

  void find_hubs() {
    std::vector<std::uint32_t> faces_at(positions_.size(), 0);
    StopCheck check(control_);
    for (const Triangle& face : faces_) {
      check();
      for (const VertexId v : face) ++faces_at[v.value];
    }
    if (std::none_of(faces_at.begin(), faces_at.end(), [](std::uint32_t n) { return n > kMaxAtVertex; })) return;
    is_hub_.resize(positions_.size());
    for (std::size_t v = 0; v < faces_at.size(); ++v) is_hub_[v] = faces_at[v] > kMaxAtVertex;
    for (std::uint32_t f = 0; f < faces_.size(); ++f) {
      check();
      const Hubs hubs = hubs_of(FaceId(f));
      for (const VertexId v : hubs)
        if (v.is_valid()) at_hub_.push_back({v, FaceId(f)});
      for_each_edge(hubs, [&](HubEdge edge) { at_edge_.push_back({edge, FaceId(f)}); });
    }
    sort_stoppable(at_hub_.begin(), at_hub_.end(), control_);
    sort_stoppable(at_edge_.begin(), at_edge_.end(), control_);
    edge_at_.resize(at_edge_.empty() ? 0 : positions_.size());
    for_each_hub_edge([&](std::size_t begin, std::size_t end) {
      const auto& [edge, face] = at_edge_[begin];
      for (const VertexId v : {edge.first, edge.second})
        if (edge_at_[v.value].faces < end - begin) edge_at_[v.value] = {edge, static_cast<std::uint32_t>(end - begin)};
    });
  }

  Hubs hubs_of(FaceId f) const {
    Hubs hubs = faces_[f.value];
    std::sort(hubs.begin(), hubs.end());
    const auto end = std::unique(hubs.begin(), hubs.end());
    std::fill(end, hubs.end(), VertexId());
    return select(hubs, [&](VertexId v) { return is_hub_[v.value] != 0; });
  }

  template <class Visit>
  static void for_each_edge(const Hubs& hubs, const Visit& visit) {
    for (const auto& [i, j] : {std::pair(0, 1), std::pair(0, 2), std::pair(1, 2)})
      if (hubs[j].is_valid()) visit(HubEdge(hubs[i], hubs[j]));
  }

  /// Calls visit(begin, end) for the faces of each edge in `at_edge_`.
  template <class Visit>
  void for_each_hub_edge(const Visit& visit) const {
    StopCheck check(control_);
    for (std::size_t begin = 0, end = 0; begin < at_edge_.size(); begin = end) {
      check();
      while (end < at_edge_.size() && at_edge_[end].first == at_edge_[begin].first) ++end;
      visit(begin, end);
    }
  }

  /// The edge with the most faces, of those between hubs of a face. If the face has none itself, the one with the most
  /// faces at any of its hubs.
  HubEdge widest_edge(FaceId f) const {
    AtEdge widest;
    if (edge_at_.empty()) return widest.edge;
    const Hubs hubs = hubs_of(f);
    for (const VertexId v : hubs) {
      if (!v.is_valid()) continue;
      const AtEdge& at = edge_at_[v.value];
      const bool is_own = at.faces > 0 && has(faces_[f.value], at.edge.first) && has(faces_[f.value], at.edge.second);
      if (std::tuple(is_own, at.faces) > std::tuple(widest.is_own, widest.faces)) widest = {at.edge, at.faces, is_own};
    }
    return widest.edge;
  }

  /// The hubs that two faces share. They decide where the two faces are compared: without a common hub, wherever their
  /// boxes meet; with one, at that hub; with more, at the edge between the first two.
  Hubs shared_hubs(FaceId f, FaceId g) const {
    if (is_hub_.empty()) return {};
    return select(hubs_of(f), [&](VertexId v) { return has(faces_[g.value], v); });
  }

  bool do_count(FaceId f, FaceId g) const {
    if (!pieces_.empty() && pieces_[f.value] == pieces_[g.value] && pieces_[f.value] != kNoPiece) return false;
    return !search_.is_passed_over(f, g) && do_intersect(faces_[f.value], faces_[g.value], positions_);
  }

  /// Estimates the number of all pairs by those of a few slots that are spread over the tree.
  double estimate(const TriangleTree& tree) {
    constexpr std::uint64_t kMaxSteps = 1 << 23;
    constexpr std::size_t kMaxSlots = 1024;
    std::uint64_t steps = 0, told = 0, pairs = 0;
    std::size_t slots = 0;
    StopCheck check(control_);
    // The multiples of the golden ratio, without their whole parts, are spread evenly however many are taken.
    constexpr double kGoldenRatio = 0.6180339887498949;
    for (double place = 0.5; slots < std::min(kMaxSlots, tree.size()) && steps <= kMaxSteps; ++slots) {
      const auto slot = static_cast<std::size_t>(place * static_cast<double>(tree.size()));
      place += kGoldenRatio;
      place -= std::floor(place);
      tree.visit_meeting(tree.box(slot), 0, [&](std::size_t other) {
        check();
        steps += kStepsPerTest;
        pairs += slot != other && do_count(tree.face(slot), tree.face(other));
        return true;
      });
      search_.report_progress(steps - told);
      told = steps;
    }
    const auto n = static_cast<double>(tree.size());
    return slots == 0 ? 0 : n * static_cast<double>(pairs) / (2 * static_cast<double>(slots));
  }

  std::size_t find_everywhere() {
    static_assert(kNoPiece == TriangleTree::kNoGroup);
    const std::size_t done = find_pairs(
        {.positions = positions_, .faces = faces_, .groups = pieces_}, [](FaceId f) { return f; },
        [&](const TriangleTree& tree) { return View(*this, tree); },
        [&](FaceId f, FaceId g) { return !shared_hubs(f, g)[0].is_valid() && do_count(f, g); }, search_);
    if (!search_.goes_on() && search_.limits().is_estimate_wanted)
      search_.result().estimated_pairs = std::max(estimate(TriangleTree(positions_, faces_, control_, pieces_)),
                                                  static_cast<double>(search_.result().pairs.size()));
    return done;
  }

  /// Knows the nodes of a tree over all faces.
  class View {
   public:
    View(const Search& search, const TriangleTree& tree) : search_(search), tree_(tree) {
      if (!search.is_hub_.empty())
        hubs_ = tree.joined<Hubs>([&](std::size_t slot) { return search.hubs_of(tree.face(slot)); }, common,
                                  search.control_);
      const auto pieces = search.pieces_;
      if (std::any_of(pieces.begin(), pieces.end(), [](std::uint32_t piece) { return piece != kNoPiece; }))
        pieces_ = tree.joined<std::uint32_t>([&](std::size_t slot) { return pieces[tree.face(slot).value]; },
                                             [](std::uint32_t a, std::uint32_t b) { return a == b ? a : kNoPiece; },
                                             search.control_);
    }

    bool is_of_no_interest(FaceId f, std::size_t slot, std::size_t node) const {
      if (!pieces_.empty() && pieces_[node] != kNoPiece && pieces_[node] == search_.pieces_[f.value]) return true;
      if (axial_.are_apart(slot, node)) return true;
      const Triangle& face = search_.faces_[f.value];
      return !hubs_.empty() && std::any_of(hubs_[node].begin(), hubs_[node].end(),
                                           [&](VertexId v) { return v.is_valid() && has(face, v); });
    }
    bool lose_interest(std::span<const std::uint32_t> slots) {
      const auto edge_of = [&](std::size_t slot) { return search_.widest_edge(tree_.face(slot)); };
      return axial_.prepare(tree_, search_.positions_, search_.faces_, slots, edge_of, search_.control_);
    }

   private:
    const Search& search_;
    const TriangleTree& tree_;
    std::vector<Hubs> hubs_;             ///< by node; empty if no vertex is one
    std::vector<std::uint32_t> pieces_;  ///< by node: the piece of all its faces, or kNoPiece; empty if there are none
    AxialSearch axial_;
  };

  /// Compares faces that share two hubs. Such faces meet elsewhere, too, only if they are in one half-plane about the
  /// edge between these hubs.
  /// Output: the number of entries of `at_edge_` that were treated.
  std::size_t find_at_edges() {
    if (!search_.goes_on()) return 0;
    struct Grouped {
      HubEdge edge;
      FaceId face;
      std::size_t group_end;
    };
    std::vector<Grouped> faces;
    std::vector<Page> pages;
    for_each_hub_edge([&](std::size_t begin, std::size_t end) {
      const auto [from, to] = at_edge_[begin].first;
      pages.clear();
      for (std::size_t i = begin; i < end; ++i) {
        if (i % kFacesBetweenChecks == 0) control_.check_and_move();
        // A face without a third corner is the edge itself. It meets the other faces only in shared vertices and edges.
        for (const VertexId v : faces_[at_edge_[i].second.value])
          if (v != from && v != to) pages.push_back({v, at_edge_[i].second});
      }
      std::size_t first = 0;
      for (const std::size_t last :
           group_by_half_plane(positions_[from.value], positions_[to.value], positions_, pages, control_)) {
        const std::size_t group_end = faces.size() + last - first;
        if (last - first > 1)
          for (std::size_t i = first; i < last; ++i) faces.push_back({{from, to}, pages[i].face, group_end});
        first = last;
      }
    });
    const std::size_t done =
        gather_pairs(faces.size(), kFacesPerTask, search_, [&](std::size_t i, FoundInTurn& found, std::size_t room) {
          std::uint32_t tests = 0;
          for (std::size_t j = i + 1; j < faces[i].group_end && found.pairs.size() <= room; ++j) {
            if (++tests % kFacesBetweenChecks == 0) control_.check_and_move();
            const FaceId f = faces[i].face, g = faces[j].face;
            const Hubs shared = shared_hubs(f, g);
            if (HubEdge(shared[0], shared[1]) == faces[i].edge && do_count(f, g)) found.pairs.push_back({f, g});
          }
          found.steps += kStepsPerTest * (tests + 1);
        });
    // Faces that are alone in their half-plane count as treated, too.
    return at_edge_.size() - (faces.size() - done);
  }

  /// Compares the faces at one hub. Seen from the hub, the faces are arcs, and two faces that share nothing else meet
  /// elsewhere, too, only if their arcs meet.
  /// Output: the number of entries of `at_hub_` that were treated.
  std::size_t find_at_hub(std::size_t begin, std::size_t end) {
    const VertexId hub = at_hub_[begin].first;
    std::vector<Vec3> corners;
    std::vector<Triangle> arcs, faces;
    bool are_wide = false;
    for (std::size_t i = begin; i < end; ++i) {
      if (i % kFacesBetweenChecks == 0) control_.check_and_move();
      faces.push_back(faces_[at_hub_[i].second.value]);
      const auto arc = around_arc(hub, faces.back());
      are_wide = are_wide || !arc;
      for (const Vec3& corner : arc.value_or(kWholeSphere)) corners.push_back(corner);
      const std::size_t n = corners.size();
      arcs.push_back({VertexId(n - 3), VertexId(n - 2), VertexId(n - 1)});
    }
    const auto face_of = [&](FaceId arc) { return at_hub_[begin + arc.value].second; };
    return find_pairs(
        {.positions = corners,
         .faces = arcs,
         .margin = kDirectionMargin,
         .by = are_wide ? SearchedTriangles::kByBoxes : SearchedTriangles::kByTriangles},
        face_of,
        [&](const TriangleTree& tree) { return ViewFromHub(*this, tree, std::span(at_hub_).subspan(begin), faces); },
        [&](FaceId arc, FaceId other) {
          const FaceId f = face_of(arc), g = face_of(other);
          const Hubs shared = shared_hubs(f, g);
          return shared[0] == hub && !shared[1].is_valid() && do_count(f, g);
        },
        search_);
  }

  /// Knows the nodes of a tree over the faces at a hub.
  class ViewFromHub {
   public:
    /// Input:   `at_hub` has the face for each arc of the tree, and `faces` its corners.
    ViewFromHub(const Search& search, const TriangleTree& tree, std::span<const std::pair<VertexId, FaceId>> at_hub,
                std::span<const Triangle> faces)
        : search_(search), tree_(tree), at_hub_(at_hub), faces_(faces) {
      hubs_ =
          tree.joined<Hubs>([&](std::size_t slot) { return search.hubs_of(face_of(slot)); }, common, search.control_);
    }

    bool is_of_no_interest(FaceId arc, std::size_t slot, std::size_t node) const {
      if (axial_.are_apart(slot, node)) return true;
      const Triangle& face = faces_[arc.value];
      return std::count_if(hubs_[node].begin(), hubs_[node].end(),
                           [&](VertexId v) { return v.is_valid() && has(face, v); }) > 1;
    }
    bool lose_interest(std::span<const std::uint32_t> slots) {
      const auto edge_of = [&](std::size_t slot) { return search_.widest_edge(face_of(slot)); };
      return axial_.prepare(tree_, search_.positions_, faces_, slots, edge_of, search_.control_);
    }

   private:
    FaceId face_of(std::size_t slot) const { return at_hub_[tree_.face(slot).value].second; }

    const Search& search_;
    const TriangleTree& tree_;
    std::span<const std::pair<VertexId, FaceId>> at_hub_;
    std::span<const Triangle> faces_;
    std::vector<Hubs> hubs_;  ///< by node
    AxialSearch axial_;
  };

  /// A triangle of directions that contains the arc of a face: the arc's two ends, and the point where the tangents
  /// there cross. Empty if that point is far away.
  std::optional<std::array<Vec3, 3>> around_arc(VertexId hub, const Triangle& face) const {
    std::array<Vec3, 2> ends;
    std::size_t n = 0;
    for (const VertexId v : face)
      if (v != hub && n < 2) ends[n++] = normalized(positions_[v.value] - positions_[hub.value]);
    if (n == 1) ends[1] = ends[0];
    const Vec3 middle = 0.5 * (ends[0] + ends[1]);
    const double cosine_squared = norm_squared(middle);
    constexpr double kWide = 0.01;  // reached at some 168 degrees
    if (cosine_squared < kWide) return std::nullopt;
    return std::array{ends[0], ends[1], (1 / cosine_squared) * middle};
  }

  std::vector<Vec3> positions_;
  std::span<const Triangle> faces_;
  std::span<const std::uint32_t> pieces_;
  RunControl& control_;
  std::vector<std::uint8_t> is_hub_;                 ///< per vertex; empty if none is
  std::vector<std::pair<VertexId, FaceId>> at_hub_;  ///< sorted
  std::vector<std::pair<HubEdge, FaceId>> at_edge_;  ///< sorted
  std::vector<AtEdge> edge_at_;                      ///< per vertex: the edge between hubs with the most faces
  PairSearch search_;
};

}  // namespace

SelfIntersections self_intersections(std::span<const Vec3> positions, std::span<const Triangle> faces,
                                     std::span<const std::uint32_t> pieces, const SearchLimits& limits,
                                     RunControl& control) {
  return Search(positions, faces, pieces, limits, control).run();
}

}  // namespace remesh
