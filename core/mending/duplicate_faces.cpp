#include "core/mending/duplicate_faces.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"
#include "core/base/union_find.h"
#include "core/mending/back_to_back.h"
#include "core/mending/body_labels.h"

namespace remesh {
namespace {

class Duplicates {
 public:
  Duplicates(const Surface& surface, const Adjacency& edges, const FaceLabels& labels, RunControl& control)
      : surface_(surface), edges_(edges), labels_(labels), control_(control) {}

  /// Output: what to do with each face; empty if none repeats another.
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
    sort_stoppable(edges.begin(), edges.end(), control_);
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
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

  static constexpr std::uint8_t kStays = 0, kDropped = 1, kBack = 2, kCopy = 3;

 private:
  /// Finds all faces that may repeat another one. The other face is at each of their edges then, so it suffices to look
  /// at one edge.
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

  /// Returns whether two faces at an edge have the same next vertex, seen in one direction. Most have not, and need no
  /// closer look.
  bool do_go_on_alike(std::uint32_t g, std::uint32_t h) const {
    const VertexId after = edges_.to(edges_.next(g));
    return edges_.from(g) == edges_.from(h) ? after == edges_.to(edges_.next(h)) : after == edges_.from(before(h));
  }
  std::uint32_t before(std::uint32_t h) const {
    const std::uint32_t f = edges_.face_of(h).value;
    return h == surface_.face_begin[f] ? surface_.face_begin[f + 1] - 1 : h - 1;
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

  /// Decides on faces over one loop, ascending. One face of each orientation is left.
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
      if (best.is_valid()) fate_[(extent(f) < extent(best) ? best : f).value] = kDropped;
      if (!best.is_valid() || extent(f) < extent(best)) best = f;
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

  /// The extent of everything that has the same labels as a face. A wall that two bodies share belongs to the smaller
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
    sort_stoppable(edges.begin(), edges.end(), control_);
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
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

  /// Decides on copies. A copy is the wall of a second body if only with it as many faces run one way as the other
  /// along its edges.
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
    StopCheck check(control_);
    decide(kBack, [&](EdgeId e) {
      std::size_t left = 0;
      for (const std::uint32_t h : edges_.half_edges(e)) {
        check();
        const std::uint8_t fate = fate_[edges_.face_of(h).value];
        left += fate == kStays || fate == kCopy;
      }
      return left != 2;
    });
  }

  void decide_on_sides() {
    std::erase_if(pairs_, [&](const BackToBack& pair) { return fate_[pair.second.value] != kDropped; });
    if (pairs_.empty()) return;
    std::vector<std::uint8_t> is_dropped(fate_.size());
    for (std::size_t f = 0; f < fate_.size(); ++f) is_dropped[f] = fate_[f] == kDropped;
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

bool drop_duplicate_faces(Surface& surface, const Adjacency& edges, const FaceLabels& labels, Mend mend,
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
  FaceList staying;
  StopCheck check(control);
  for (std::uint32_t i = 0; i < surface.face_count(); ++i) {
    check();
    const FaceId f(i);
    const std::uint32_t source = surface.face_source[f].value;
    const bool is_dropped = fate[i] == Duplicates::kDropped && mend == Mend::kYes;
    if (fate[i] != Duplicates::kStays) (is_dropped ? dropped : mend == Mend::kYes ? back : left).add(source);
    if (!is_dropped) staying.add_face(surface.face(f), surface.face_source[f], surface.label(f));
  }
  const bool is_changed = dropped.count > 0;
  for (Diagnostic* d : {&dropped, &back, &left})
    if (d->count > 0) diagnostics.push_back(std::move(*d));
  if (is_changed) surface.take_faces(std::move(staying));
  return is_changed;
}

}  // namespace remesh
