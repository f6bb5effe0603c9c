#include "core/mending/faces/duplicate_faces.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"
#include "core/base/union_find.h"
#include "core/mending/common/body_labels.h"
#include "core/mending/faces/back_to_back.h"
#include "core/mesh/unused_vertices.h"

namespace remesh {
namespace {

/// These are the decisions on faces. The second face of a pair that stands back to back is a kBack until it is known
/// which of the two are dropped.
enum Fate : std::uint8_t { kStays = 0, kDropped = 1, kBack = 2, kCopy = 3, kFin = 4 };

/// Decides on pairs of faces that stand back to back. Pairs that hang together over edges with no other faces are a
/// sheet, and each sheet is judged by itself.
class Sheets {
 public:
  /// Input: `edges_of_pairs` are all edges of the pairs. Both `fate` and `pairs` change: pairs that go as a whole are
  ///        taken off the list.
  Sheets(const Surface& surface, const Adjacency& edges, std::vector<EdgeId> edges_of_pairs,
         std::vector<std::uint8_t>& fate, std::vector<BackToBack>& pairs, RunControl& control)
      : surface_(surface),
        edges_(edges),
        edges_of_pairs_(std::move(edges_of_pairs)),
        fate_(fate),
        pairs_(pairs),
        control_(control) {}

  void decide() {
    find_sheets();
    drop_one_side();
    drop_fins();
  }

 private:
  bool is_in_pair(FaceId f) const { return pair_of_[f.value] != kNone; }

  /// The number of faces at an edge that stay for certain.
  std::size_t count_others(EdgeId e) const {
    std::size_t others = 0;
    for (const std::uint32_t h : edges_.half_edges(e)) {
      const FaceId f = edges_.face_of(h);
      others += !is_in_pair(f) && fate_[f.value] != kDropped;
    }
    return others;
  }

  /// Calls visit(edge, pairs) for each edge of pairs, with the numbers of the pairs at that edge.
  template <class Visit>
  void for_each_edge(const Visit& visit) const {
    StopCheck check(control_);
    std::vector<std::uint32_t> here;
    for (const EdgeId e : edges_of_pairs_) {
      here.clear();
      for (const std::uint32_t h : edges_.half_edges(e)) {
        check();
        if (const FaceId f = edges_.face_of(h); fate_[f.value] == kBack) here.push_back(pair_of_[f.value]);
      }
      visit(e, std::span<const std::uint32_t>(here));
    }
  }

  void find_sheets() {
    pair_of_.assign(surface_.face_count(), kNone);
    for (std::uint32_t i = 0; i < pairs_.size(); ++i)
      pair_of_[pairs_[i].first.value] = pair_of_[pairs_[i].second.value] = i;
    UnionFind sheets(pairs_.size());
    for_each_edge([&](EdgeId e, std::span<const std::uint32_t> here) {
      if (here.size() == 2 && count_others(e) == 0) sheets.join(here[0], here[1]);
    });
    sheet_of_.resize(pairs_.size());
    for (std::uint32_t i = 0; i < pairs_.size(); ++i) sheet_of_[i] = sheets.find(i);
  }

  /// Drops one side of each sheet if each of the sheet's edges has exactly two faces then. Where several such sheets
  /// meet, that holds for all of them together, or none of them changes.
  void drop_one_side() {
    std::vector<std::uint8_t> is_single(pairs_.size(), 1);  // by sheet
    const auto refuse = [&](bool do_others_count) {
      std::vector<std::uint32_t> refused;
      for_each_edge([&](EdgeId e, std::span<const std::uint32_t> here) {
        const std::size_t others = count_others(e);
        for (const std::uint32_t pair : here) {
          const auto counts = [&](std::uint32_t other) {
            return sheet_of_[other] == sheet_of_[pair] || (do_others_count && is_single[sheet_of_[other]] != 0);
          };
          if (here.size() > kFewPairs ||
              others + static_cast<std::size_t>(std::count_if(here.begin(), here.end(), counts)) != 2)
            refused.push_back(sheet_of_[pair]);
        }
      });
      for (const std::uint32_t sheet : refused) is_single[sheet] = 0;
    };
    refuse(false);
    refuse(true);
    for (std::uint32_t i = 0; i < pairs_.size(); ++i)
      if (is_single[sheet_of_[i]]) fate_[pairs_[i].second.value] = kDropped;
  }

  /// Drops both sides of sheets that have a free edge, and that stand on closed surfaces. These enclose nothing, and
  /// without them the surfaces stay closed. Sheets that stand on each other are judged together.
  void drop_fins() {
    std::vector<std::uint8_t> is_fin(pairs_.size(), 0);  // by sheet
    const auto is_left = [&](std::uint32_t pair) { return fate_[pairs_[pair].second.value] == kBack; };
    for_each_edge([&](EdgeId e, std::span<const std::uint32_t> here) {
      if (here.size() == 1 && is_left(here[0]) && count_others(e) == 0) is_fin[sheet_of_[here[0]]] = 1;
    });
    if (std::find(is_fin.begin(), is_fin.end(), 1) == is_fin.end()) return;
    const auto is_of_fin = [&](FaceId f) { return is_in_pair(f) && is_fin[sheet_of_[pair_of_[f.value]]] != 0; };
    // The faces that are left without fins form pieces, which hang together over edges.
    UnionFind pieces(surface_.face_count());
    std::vector<std::uint8_t> is_open(surface_.face_count(), 0);
    const auto count_left = [&](EdgeId e, std::uint32_t& first) {
      std::size_t left = 0;
      for (const std::uint32_t h : edges_.half_edges(e)) {
        const FaceId f = edges_.face_of(h);
        if (fate_[f.value] == kDropped || is_of_fin(f)) continue;
        if (left++ == 0) first = f.value;
        pieces.join(first, f.value);
      }
      return left;
    };
    StopCheck check(control_);
    std::vector<std::uint32_t> with_odd_edges;
    for (std::size_t e = 0; e < edges_.edge_count(); ++e) {
      check();
      if (std::uint32_t first = kNone; count_left(EdgeId(e), first) % 2 != 0) with_odd_edges.push_back(first);
    }
    for (const std::uint32_t f : with_odd_edges) is_open[pieces.find(f)] = 1;
    // Fins that stand on each other form a group.
    UnionFind groups(pairs_.size());
    for_each_edge([&](EdgeId, std::span<const std::uint32_t> here) {
      std::uint32_t first = kNone;
      for (const std::uint32_t pair : here) {
        if (is_fin[sheet_of_[pair]] == 0) continue;
        if (first == kNone) first = sheet_of_[pair];
        groups.join(first, sheet_of_[pair]);
      }
    });
    std::vector<std::uint8_t> does_stand(pairs_.size(), 0), has_to_stay(pairs_.size(), 0);  // by group
    for_each_edge([&](EdgeId e, std::span<const std::uint32_t> here) {
      std::uint32_t first = kNone;
      const std::size_t left = count_left(e, first);
      for (const std::uint32_t pair : here) {
        if (is_fin[sheet_of_[pair]] == 0 || left == 0) continue;
        (is_open[pieces.find(first)] ? has_to_stay : does_stand)[groups.find(sheet_of_[pair])] = 1;
      }
    });
    std::erase_if(pairs_, [&](const BackToBack& pair) {
      const std::uint32_t sheet = sheet_of_[pair_of_[pair.first.value]];
      if (is_fin[sheet] == 0) return false;
      const std::uint32_t group = groups.find(sheet);
      if (does_stand[group] == 0 || has_to_stay[group] != 0) return false;
      fate_[pair.first.value] = fate_[pair.second.value] = kFin;
      return true;
    });
  }

  /// An edge with more pairs than this has too many faces, whichever of them go.
  static constexpr std::size_t kFewPairs = 8;

  const Surface& surface_;
  const Adjacency& edges_;
  const std::vector<EdgeId> edges_of_pairs_;
  std::vector<std::uint8_t>& fate_;
  std::vector<BackToBack>& pairs_;
  RunControl& control_;
  std::vector<std::uint32_t> pair_of_;   ///< by face; kNone if it is in no pair
  std::vector<std::uint32_t> sheet_of_;  ///< by pair; a sheet has the number of one of its pairs
};

class Duplicates {
 public:
  Duplicates(const Surface& surface, const Adjacency& edges, const FaceLabels& labels, RunControl& control)
      : surface_(surface), edges_(edges), labels_(labels), control_(control) {}

  /// Output: the fate of each face; empty if no face repeats another.
  const std::vector<std::uint8_t>& find() {
    const std::vector<FaceId> suspects = find_suspects();
    if (suspects.empty()) return fate_;
    find_first_half_edges();
    std::vector<EdgeId> edges;
    StopCheck check(control_);
    for (const FaceId f : suspects) {
      check();
      if (first_[f.value] != kNone) edges.push_back(edges_.edge_of(first_[f.value]));
    }
    sort_unique(edges, control_);
    for (const EdgeId e : edges) {
      faces_.clear();
      for (const std::uint32_t h : edges_.half_edges(e)) {
        check();
        if (is_first(h)) faces_.push_back(edges_.face_of(h));
      }
      if (faces_.size() > 1) compare();
    }
    if (!fate_.empty()) {
      decide_on_copies();
      decide_on_backs();
      decide_on_sides();
    }
    return fate_;
  }

 private:
  /// Finds all faces that may repeat another one. A face that repeats another shares all edges with it, so it suffices
  /// to test one edge.
  std::vector<FaceId> find_suspects() const {
    auto suspects = select_ids<FaceId>(surface_.face_count(), kItemsPerBlock, control_, [&](std::size_t f) {
      const std::uint32_t h = surface_.face_begin[f], twin = edges_.twin(h);
      return twin != kNone && do_go_on_alike(h, twin);
    });
    StopCheck check(control_);
    for (const EdgeId e : edges_.odd_edges()) {
      check();
      const auto around = edges_.half_edges(e);
      // An edge between a corner and its repetition has no direction.
      const bool is_point = edges_.from(around[0]) == edges_.to(around[0]);
      if (around.size() > 2 || (around.size() == 2 && (is_point || do_go_on_alike(around[0], around[1]))))
        for (const std::uint32_t h : around) suspects.push_back(edges_.face_of(h));
    }
    return suspects;
  }

  /// Returns whether two faces at an edge have the same next vertex, seen in one direction. Most faces do not, and need
  /// no closer test.
  bool do_go_on_alike(std::uint32_t g, std::uint32_t h) const {
    const VertexId after = edges_.to(edges_.next(g));
    return edges_.from(g) == edges_.from(h) ? after == edges_.to(edges_.next(h))
                                            : after == edges_.from(edges_.previous(h));
  }

  /// Finds for each face the half-edge between its smallest vertex and the smaller of that vertex's neighbours. This is
  /// the same edge for all faces over the same loop, whichever way they run.
  void find_first_half_edges() {
    first_.resize(surface_.face_count());
    for_blocks(surface_.face_count(), kItemsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) first_[f] = first_half_edge(f);
    });
  }

  std::uint32_t first_half_edge(std::size_t f) const {
    const std::uint32_t begin = surface_.face_begin[f], end = surface_.face_begin[f + 1];
    std::uint32_t least = begin;
    std::size_t times = 1;
    for (std::uint32_t h = begin + 1; h < end; ++h) {
      if (surface_.corners[h] == surface_.corners[least]) ++times;
      if (surface_.corners[h] < surface_.corners[least]) {
        least = h;
        times = 1;
      }
    }
    if (times > 1) return kNone;
    const std::uint32_t before = least == begin ? end - 1 : least - 1, after = least + 1 == end ? begin : least + 1;
    return surface_.corners[before] < surface_.corners[after] ? before : least;
  }

  bool is_first(std::uint32_t h) const { return first_[edges_.face_of(h).value] == h; }

  bool runs_forward(FaceId f) const {
    const std::uint32_t h = first_[f.value];
    return edges_.from(h) < edges_.to(h);
  }

  /// Vertex number i of the loop. The count begins at the smallest vertex and goes towards its smaller neighbour.
  VertexId vertex(FaceId f, std::size_t i) const {
    const auto loop = surface_.face(f);
    const std::size_t first = first_[f.value] - surface_.face_begin[f.value], n = loop.size();
    return runs_forward(f) ? loop[(first + i) % n] : loop[(first + 1 + n - i) % n];
  }

  int order(FaceId f, FaceId g) const {
    const std::size_t n = surface_.face(f).size(), m = surface_.face(g).size();
    if (n != m) return n < m ? -1 : 1;
    for (std::size_t i = 0; i < n; ++i)
      if (const VertexId a = vertex(f, i), b = vertex(g, i); a != b) return a < b ? -1 : 1;
    return 0;
  }

  /// Compares the faces whose first half-edges are on one edge.
  void compare() {
    sort_stoppable(faces_.begin(), faces_.end(), control_, [&](FaceId f, FaceId g) {
      const int sign = order(f, g);
      return sign != 0 ? sign < 0 : f < g;
    });
    StopCheck check(control_);
    for (std::size_t i = 0; i < faces_.size();) {
      const std::size_t begin = i;
      while (++i < faces_.size() && order(faces_[begin], faces_[i]) == 0) check();
      if (i - begin > 1) decide_on(std::span(faces_).subspan(begin, i - begin));
    }
  }

  /// Decides on faces over one loop, ascending. One face of each orientation stays.
  void decide_on(std::span<const FaceId> alike) {
    if (fate_.empty()) {
      fate_.assign(surface_.face_count(), kStays);
      measure_labels();
    }
    StopCheck check(control_);
    std::array<FaceId, 2> left;
    for (const FaceId f : alike) {
      check();
      FaceId& best = left[runs_forward(f) ? 1 : 0];
      const bool is_better = best.is_valid() && is_rather_left(f, best);
      if (best.is_valid()) fate_[(is_better ? best : f).value] = kDropped;
      if (!best.is_valid() || is_better) best = f;
    }
    if (!left[0].is_valid() || !left[1].is_valid()) {
      for (const FaceId f : alike)
        if (fate_[f.value] == kDropped) fate_[f.value] = kCopy;
      return;
    }
    const auto [first, second] = std::minmax(left[0], left[1]);
    fate_[second.value] = kBack;
    pairs_.push_back({first, second});
  }

  /// Returns whether the face f stays rather than g, which comes before it.
  bool is_rather_left(FaceId f, FaceId g) const {
    return extent(f) != extent(g) ? extent(f) < extent(g) : is_piece(g) && !is_piece(f);
  }

  /// Returns whether a face is a piece of an input face.
  bool is_piece(FaceId f) const {
    const FaceId source = surface_.face_source[f];
    return (f.value > 0 && surface_.face_source[FaceId(f.value - 1)] == source) ||
           (f.value + 1 < surface_.face_count() && surface_.face_source[FaceId(f.value + 1)] == source);
  }

  void measure_labels() {
    of_faces_ = labels_of_sources(labels_, surface_.face_source.items(), control_);
    if (of_faces_.are_alike()) return;
    std::vector<Box3> boxes(of_faces_.begin.size() - 1);
    StopCheck check(control_);
    for (std::uint32_t f = 0; f < surface_.face_count(); ++f) {
      check();
      for (const VertexId v : surface_.face(FaceId(f))) boxes[of_faces_.set_of[f]].add(surface_.local[v]);
    }
    for (const Box3& box : boxes) extents_.push_back(box.diagonal());
  }

  /// The extent of all faces that have the same labels as a face. A wall that two bodies share belongs to the smaller
  /// one.
  double extent(FaceId f) const { return extents_.empty() ? 0 : extents_[of_faces_.set_of[f.value]]; }

  /// The edges of the faces with this fate. Each edge is listed once, because many such faces may share an edge.
  std::vector<EdgeId> edges_of(std::uint8_t fate) const {
    std::vector<EdgeId> edges;
    StopCheck check(control_);
    for (std::uint32_t f = 0; f < surface_.face_count(); ++f) {
      check();
      if (fate_[f] == fate)
        for (std::uint32_t h = surface_.face_begin[f]; h < surface_.face_begin[f + 1]; ++h)
          edges.push_back(edges_.edge_of(h));
    }
    sort_unique(edges, control_);
    return edges;
  }

  /// Drops connected faces with this fate together, unless is_needed(e) holds for one of their edges.
  template <class IsNeeded>
  void decide(std::uint8_t fate, const IsNeeded& is_needed) {
    const std::vector<EdgeId> edges = edges_of(fate);
    if (edges.empty()) return;
    UnionFind cluster(surface_.face_count());
    StopCheck check(control_);
    std::vector<std::uint32_t> needed;
    for (const EdgeId e : edges) {
      std::uint32_t first = kNone;
      for (const std::uint32_t h : edges_.half_edges(e)) {
        check();
        const std::uint32_t f = edges_.face_of(h).value;
        if (fate_[f] != fate) continue;
        if (first == kNone)
          first = f;
        else
          cluster.join(first, f);
      }
      if (is_needed(e)) needed.push_back(first);
    }
    std::vector<std::uint8_t> has_to_stay(surface_.face_count(), 0);
    for (const std::uint32_t f : needed) has_to_stay[cluster.find(f)] = 1;
    for (std::uint32_t f = 0; f < surface_.face_count(); ++f)
      if (fate_[f] == fate && !has_to_stay[cluster.find(f)]) fate_[f] = kDropped;
  }

  /// Decides on copies. A copy is the wall of a second body if the faces along its edges run equally often in both
  /// directions with the copy, and not without it.
  void decide_on_copies() {
    StopCheck check(control_);
    decide(kCopy, [&](EdgeId e) {
      const auto around = edges_.half_edges(e);
      int with = 0, without = 0;
      for (const std::uint32_t h : around) {
        check();
        const std::uint8_t fate = fate_[edges_.face_of(h).value];
        const int run = edges_.from(h) == edges_.from(around[0]) ? 1 : -1;
        if (fate != kDropped) with += run;
        if (fate != kDropped && fate != kCopy) without += run;
      }
      return with == 0 && without != 0;
    });
  }

  void decide_on_backs() {
    if (!pairs_.empty()) Sheets(surface_, edges_, edges_of(kBack), fate_, pairs_, control_).decide();
  }

  void decide_on_sides() {
    std::erase_if(pairs_, [&](const BackToBack& pair) { return fate_[pair.second.value] != kDropped; });
    if (pairs_.empty()) return;
    std::vector<std::uint8_t> is_dropped(fate_.size());
    for (std::size_t f = 0; f < fate_.size(); ++f) is_dropped[f] = fate_[f] == kDropped || fate_[f] == kFin;
    choose_sides(surface_, edges_, labels_, of_faces_, is_dropped, pairs_, control_);
    for (const BackToBack& pair : pairs_)
      if (!pair.does_first_stay) std::swap(fate_[pair.first.value], fate_[pair.second.value]);
  }

  const Surface& surface_;
  const Adjacency& edges_;
  const FaceLabels& labels_;
  RunControl& control_;
  std::vector<BackToBack> pairs_;
  BodyLabels of_faces_;
  std::vector<double> extents_;  ///< one per set of labels; empty if all labels are equal
  std::vector<std::uint32_t, DefaultInit<std::uint32_t>> first_;  ///< one per face
  std::vector<std::uint8_t> fate_;
  std::vector<FaceId> faces_;
};

}  // namespace

bool drop_duplicate_faces(Surface& surface, const Adjacency& edges, const FaceLabels& labels, MendMode mend,
                          std::vector<Diagnostic>& diagnostics, RunControl& control) {
  Duplicates duplicates(surface, edges, labels, control);
  const std::vector<std::uint8_t>& fate = duplicates.find();
  if (fate.empty()) return false;
  Diagnostic dropped{DiagnosticCode::kDuplicateFace, 0, {}, "faces that repeat another face were dropped"};
  Diagnostic left{DiagnosticCode::kDuplicateFace,
                  0,
                  {},
                  "faces repeat another face and were left, because `repair` does not include `duplicates`"};
  Diagnostic back{
      DiagnosticCode::kDuplicateFace,
      0,
      {},
      "faces repeat another face, most of them with the opposite orientation, and were left: without them the surface "
      "would be open or have edges with three faces"};
  Diagnostic fins{DiagnosticCode::kDuplicateFace,
                  0,
                  {},
                  "faces stand back to back on a closed surface, like a fin, and enclose nothing; both sides were "
                  "dropped"};
  FaceList staying;
  StopCheck check(control);
  for (std::uint32_t i = 0; i < surface.face_count(); ++i) {
    check();
    const FaceId f(i);
    const std::uint32_t source = surface.face_source[f].value;
    const bool is_dropped = fate[i] == kDropped && mend == MendMode::kYes;
    const bool is_fin = fate[i] == kFin && mend == MendMode::kYes;
    // Pieces of one input face count once.
    const bool is_counted =
        i > 0 && surface.face_source[FaceId(i - 1)] == surface.face_source[f] && fate[i - 1] == fate[i];
    if (fate[i] != kStays && !is_counted)
      (is_fin ? fins : is_dropped ? dropped : mend == MendMode::kYes ? back : left).add(source);
    if (!is_dropped && !is_fin) staying.add_face(surface.face(f), surface.face_source[f], surface.label(f));
  }
  const bool are_fins_gone = fins.count > 0, is_changed = dropped.count > 0 || are_fins_gone;
  for (Diagnostic* d : {&dropped, &fins, &back, &left})
    if (d->count > 0) diagnostics.push_back(std::move(*d));
  if (is_changed) surface.take_faces(std::move(staying));
  if (are_fins_gone) drop_unused_vertices(surface, control);
  return is_changed;
}

}  // namespace remesh
