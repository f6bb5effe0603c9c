#include "core/mending/edges/seams.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <tuple>

#include "core/base/blocks.h"
#include "core/base/number_text.h"
#include "core/base/stoppable.h"
#include "core/mesh/unused_vertices.h"

namespace remesh {
namespace {

/// Sets of vertices that become one. Only vertices at the ends of partners are in such sets.
class Clusters {
 public:
  Clusters(const Surface& surface, const JoinedPlaces& joined, std::vector<VertexId> vertices, RunControl& control)
      : surface_(surface), vertices_(std::move(vertices)) {
    sort_unique(vertices_, control);
    clusters_.reserve(vertices_.size());
    StopCheck check(control);
    for (std::uint32_t k = 0; k < vertices_.size(); ++k) {
      check();
      clusters_.push_back({k, 1, vertices_[k], joined.box_of(surface, vertices_[k])});
    }
  }

  /// Returns whether all vertices of the two clusters together lie in a box with a diagonal of at most `limit`.
  bool can_join(VertexId a, VertexId b, double limit) const {
    Box3 box = clusters_[root(number(a))].box;
    box.add(clusters_[root(number(b))].box);
    return box.diagonal() <= limit;
  }

  void join(VertexId a, VertexId b) {
    std::uint32_t first = root(number(a)), second = root(number(b));
    if (first == second) return;
    if (clusters_[first].size < clusters_[second].size) std::swap(first, second);
    Cluster &larger = clusters_[first], &smaller = clusters_[second];
    larger.box.add(smaller.box);
    larger.size += smaller.size;
    if (surface_.positions[smaller.least] < surface_.positions[larger.least]) larger.least = smaller.least;
    smaller.parent = first;
  }

  /// Calls visit(vertex, the vertex that it becomes, the box of the cluster) for all vertices in clusters of two or
  /// more.
  template <class Visit>
  void for_each_joined(RunControl& control, const Visit& visit) const {
    StopCheck check(control);
    for (std::uint32_t k = 0; k < vertices_.size(); ++k) {
      check();
      const Cluster& cluster = clusters_[root(k)];
      if (cluster.size > 1) visit(vertices_[k], cluster.least, cluster.box);
    }
  }

 private:
  struct Cluster {
    std::uint32_t parent, size;
    VertexId least;  ///< the cluster's vertex with the lexicographically smallest place
    Box3 box;
  };

  std::uint32_t number(VertexId v) const {
    return static_cast<std::uint32_t>(std::lower_bound(vertices_.begin(), vertices_.end(), v) - vertices_.begin());
  }
  // Smaller clusters are joined to larger ones, so the path to the root is at most logarithmic.
  std::uint32_t root(std::uint32_t k) const {
    while (clusters_[k].parent != k) k = clusters_[k].parent;
    return k;
  }

  const Surface& surface_;
  std::vector<VertexId> vertices_;
  std::vector<Cluster> clusters_;
};

class SeamClosing {
 public:
  SeamClosing(const Surface& surface, const Adjacency& edges, const OpenEdges& open, const SeamRules& rules,
              const JoinedPlaces& joined, RunControl& control)
      : surface_(surface), edges_(edges), open_(open), rules_(rules), joined_(joined), control_(control) {}

  /// Finds which vertices become one. Output: false if none do.
  bool run(std::vector<SeamPair> pairs) {
    // The nearest pairs come first. A later pair is joined only if its clusters stay within the tolerance.
    sort_stoppable(pairs.begin(), pairs.end(), control_, [&](const SeamPair& a, const SeamPair& b) {
      if (a.fit.width != b.fit.width) return a.fit.width < b.fit.width;
      const auto first = [&](const SeamPair& p) { return open_.is_before(p.i, p.j) ? p.i : p.j; };
      return open_.is_before(first(a), first(b));
    });
    pairs_ = std::move(pairs);
    choose_pairs();
    // Leaving out a pair makes clusters smaller, which cannot violate a condition that held before. So after the second
    // look, all pairs are sound.
    while (!pairs_.empty()) {
      look();
      if (spoilt_.empty()) return true;
      StopCheck check(control_);
      const auto is_spoilt = [&](VertexId v) { return std::binary_search(spoilt_.begin(), spoilt_.end(), image_[v]); };
      pairs_.erase(std::remove_if(pairs_.begin(), pairs_.end(),
                                  [&](const SeamPair& p) {
                                    check();
                                    return is_spoilt(open_[p.i].from) || is_spoilt(open_[p.i].to);
                                  }),
                   pairs_.end());
    }
    return false;
  }

  VertexId image(VertexId v) const { return image_[v]; }
  /// One face for each open edge that is joined with another one.
  const std::vector<FaceId>& closed() const { return closed_; }
  /// Returns whether the open edge with this half-edge is joined with another one, so that it is no longer open.
  bool is_closed(std::uint32_t half_edge) const {
    return std::binary_search(closed_half_edges_.begin(), closed_half_edges_.end(), half_edge);
  }
  /// The vertices that others become, each with a box around the places of all vertices that became it.
  const std::vector<std::pair<VertexId, Box3>>& boxes() const { return boxes_; }
  double width() const {
    double width = 0;
    for (const SeamPair& pair : pairs_) width = std::max(width, pair.fit.width);
    return width;
  }

 private:
  /// An edge of which at least one end becomes one with another vertex.
  struct Moved {
    VertexId low, high;  ///< the smaller and the larger of its new ends
    VertexId old_low, old_high;
    std::uint32_t half_edge;
    bool is_forward;  ///< it runs from low to high

    auto ends() const { return std::tuple(low, high); }
    auto old_ends() const { return std::tuple(old_low, old_high); }
    friend bool operator<(const Moved& a, const Moved& b) {
      return std::tie(a.low, a.high, a.old_low, a.old_high, a.half_edge) <
             std::tie(b.low, b.high, b.old_low, b.old_high, b.half_edge);
    }
  };

  Clusters make_clusters() const {
    std::vector<VertexId> ends;
    ends.reserve(4 * pairs_.size());
    StopCheck check(control_);
    for (const SeamPair& p : pairs_) {
      check();
      for (const std::size_t k : {p.i, p.j}) ends.insert(ends.end(), {open_[k].from, open_[k].to});
    }
    return Clusters(surface_, joined_, std::move(ends), control_);
  }

  /// The ends that become one if two edges do.
  std::array<std::pair<VertexId, VertexId>, 2> ends_of(const SeamPair& p) const {
    const OpenEdge &a = open_[p.i], &b = open_[p.j];
    return {{{a.from, p.fit.runs_alike ? b.from : b.to}, {a.to, p.fit.runs_alike ? b.to : b.from}}};
  }

  /// Drops pairs of edges that must not be joined. Joining two edges puts each end of one into the same cluster as an
  /// end of the other. A pair is dropped if one of these clusters would become larger than the tolerance.
  void choose_pairs() {
    Clusters clusters = make_clusters();
    StopCheck check(control_);
    const auto is_refused = [&](const SeamPair& p) {
      check();
      // The edges are longer than any cluster, so the clusters at their two ends are independent of each other.
      const double limit = rules_.tolerance * (1 + 1e-9);
      const auto ends = ends_of(p);
      if (std::any_of(ends.begin(), ends.end(),
                      [&](const auto& e) { return !clusters.can_join(e.first, e.second, limit); }))
        return true;
      for (const auto& [a, b] : ends) clusters.join(a, b);
      return false;
    };
    std::vector<SeamPair> chosen;
    for (const SeamPair& p : pairs_)
      if (!is_refused(p)) chosen.push_back(p);
    pairs_ = std::move(chosen);
  }

  /// Joins the ends of the pairs and looks at the result: which edges close, and which vertices would violate a
  /// condition.
  void look() {
    Clusters clusters = make_clusters();
    StopCheck check(control_);
    paired_.clear();
    for (const SeamPair& p : pairs_) {
      check();
      for (const auto& [a, b] : ends_of(p)) clusters.join(a, b);
      paired_.insert(paired_.end(), {open_[p.i].half_edge, open_[p.j].half_edge});
    }
    sort_stoppable(paired_.begin(), paired_.end(), control_);
    image_ = FilledIdVector<VertexId, VertexId>::of_size(surface_.vertex_count());
    is_joined_.assign(surface_.vertex_count(), 0);
    for (std::uint32_t v = 0; v < image_.size(); ++v) {
      check();
      image_[VertexId(v)] = VertexId(v);
    }
    boxes_.clear();
    clusters.for_each_joined(control_, [&](VertexId v, VertexId least, const Box3& box) {
      image_[v] = least;
      is_joined_[v.value] = 1;
      if (v == least) boxes_.push_back({v, box});
    });
    spoilt_.clear();
    closed_.clear();
    closed_half_edges_.clear();
    look_at_edges(moved_edges());
    sort_unique(spoilt_, control_);
    sort_stoppable(closed_half_edges_.begin(), closed_half_edges_.end(), control_);
  }

  /// The edges with an end that becomes one with another vertex, in order. Also collects the vertices of faces that
  /// would collapse.
  std::vector<Moved> moved_edges() {
    std::vector<Moved> moved;
    StopCheck check(control_);
    const auto is_joined = [&](VertexId v) {
      check();
      return is_joined_[v.value] != 0;
    };
    for (std::uint32_t f = 0; f < surface_.face_count(); ++f) {
      const auto loop = surface_.face(FaceId(f));
      if (std::none_of(loop.begin(), loop.end(), is_joined)) continue;
      if (does_collapse(loop))
        for (const VertexId v : loop)
          if (is_joined(v)) spoilt_.push_back(image_[v]);
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const VertexId from = loop[i], to = loop[i + 1 == loop.size() ? 0 : i + 1];
        if (!is_joined(from) && !is_joined(to)) continue;
        const VertexId a = image_[from], b = image_[to];
        // Either a polygon has the corner twice, or the face collapses and is listed already.
        if (a == b) continue;
        const auto half_edge = static_cast<std::uint32_t>(surface_.face_begin[f] + i);
        moved.push_back({std::min(a, b), std::max(a, b), std::min(from, to), std::max(from, to), half_edge, a < b});
      }
    }
    sort_stoppable(moved.begin(), moved.end(), control_);
    return moved;
  }

  /// Returns whether a face with joined corners loses more than repeated corners.
  bool does_collapse(std::span<const VertexId> loop) {
    loop_.clear();
    for (const VertexId v : loop)
      if (loop_.empty() || loop_.back() != image_[v]) loop_.push_back(image_[v]);
    while (loop_.size() > 1 && loop_.front() == loop_.back()) loop_.pop_back();
    if (loop_.size() == loop.size() && loop.size() == 3) return false;
    const std::size_t left = loop_.size();
    sort_stoppable(loop_.begin(), loop_.end(), control_);
    const auto different = static_cast<std::size_t>(std::unique(loop_.begin(), loop_.end()) - loop_.begin());
    // A triangle that loses a corner is gone. A quadrilateral with two opposite corners in one place is a spike.
    return loop.size() == 3 || left < 3 || different < 3;
  }

  /// Tests the edges that come to lie on each other and were different ones before. As many of them must run one way as
  /// the other. Then they are the edge of one surface, or of several that touch there, as two bodies do. Anything else
  /// would not be a surface.
  /// Input: edges in order.
  void look_at_edges(std::span<const Moved> moved) {
    StopCheck check(control_);
    for (std::size_t begin = 0, end = 0; begin < moved.size(); begin = end) {
      std::size_t forward = 0, old_edges = 0;
      for (end = begin; end < moved.size() && moved[end].ends() == moved[begin].ends(); ++end) {
        check();
        forward += moved[end].is_forward;
        old_edges += end == begin || moved[end].old_ends() != moved[end - 1].old_ends();
      }
      if (old_edges == 1) continue;
      const auto group = moved.subspan(begin, end - begin);
      if (2 * forward == group.size() || may_be_turned(group)) {
        record_closed(group, old_edges - 1);
        continue;
      }
      for (const VertexId v : {moved[begin].low, moved[begin].high})
        if (is_joined_[v.value]) spoilt_.push_back(v);
    }
  }

  /// Returns whether faces may be turned over so that as many edges run one way as the other. There must be an even
  /// number of edges. If there are two, they must be known partners, which leave the surface two-sided.
  bool may_be_turned(std::span<const Moved> group) const {
    if (!rules_.takes_alike || group.size() % 2 != 0) return false;
    const auto is_paired = [&](const Moved& edge) {
      return std::binary_search(paired_.begin(), paired_.end(), edge.half_edge);
    };
    return group.size() > 2 || std::all_of(group.begin(), group.end(), is_paired);
  }

  void record_closed(std::span<const Moved> group, std::size_t joins) {
    FaceId first = edges_.face_of(group.front().half_edge);
    for (const Moved& edge : group) {
      first = std::min(first, edges_.face_of(edge.half_edge));
      closed_half_edges_.push_back(edge.half_edge);
    }
    closed_.insert(closed_.end(), joins, first);
  }

  const Surface& surface_;
  const Adjacency& edges_;
  const OpenEdges& open_;
  const SeamRules& rules_;
  const JoinedPlaces& joined_;
  RunControl& control_;
  std::vector<SeamPair> pairs_;
  std::vector<std::uint32_t> paired_;         ///< half-edges of the pairs, ascending
  FilledIdVector<VertexId, VertexId> image_;  ///< the vertex that each vertex becomes
  std::vector<std::uint8_t> is_joined_;       ///< whether it becomes one with another vertex
  std::vector<std::pair<VertexId, Box3>> boxes_;
  std::vector<VertexId> spoilt_;  ///< images of vertices that must not be joined
  std::vector<FaceId> closed_;
  std::vector<std::uint32_t> closed_half_edges_;  ///< ascending
  std::vector<VertexId> loop_;
};

}  // namespace

Box3 JoinedPlaces::box_of(const Surface& surface, VertexId v) const {
  const VertexId source = surface.vertex_source[v];
  const auto at = std::lower_bound(boxes_.begin(), boxes_.end(), source,
                                   [](const auto& box, VertexId other) { return box.first < other; });
  if (at != boxes_.end() && at->first == source) return at->second;
  return {surface.local[v], surface.local[v]};
}

void JoinedPlaces::add(const Surface& surface, const std::vector<std::pair<VertexId, Box3>>& boxes,
                       RunControl& control) {
  // Vertices that were joined again come first, so that their larger boxes win.
  std::vector<std::pair<VertexId, Box3>> all;
  StopCheck check(control);
  for (const auto& [v, box] : boxes) {
    check();
    all.push_back({surface.vertex_source[v], box});
  }
  all.insert(all.end(), boxes_.begin(), boxes_.end());
  std::stable_sort(all.begin(), all.end(), [&](const auto& a, const auto& b) {
    check();
    return a.first < b.first;
  });
  all.erase(std::unique(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first == b.first; }),
            all.end());
  boxes_ = std::move(all);
}

bool Seams::close(Surface& surface, const Adjacency& edges, MendMode mend, RunControl& control) {
  left_ = {};
  are_too_many_ = false;
  if (edges.odd_edges().empty()) return false;
  const OpenEdges open(surface, edges, OpenEdges::Which::kUnbalanced, control);
  if (open.size() == 0) return false;
  StopCheck check(control);
  const auto add = [&](Diagnostic& to, FaceId f) {
    check();
    to.add(surface.face_source[f].value);
  };
  SeamPartners partners = find_seam_partners(surface, edges, open, rules_, control);
  if (!partners.is_complete) {
    are_too_many_ = true;
    for (std::size_t i = 0; i < open.size(); ++i)
      if (open[i].is_open) add(left_, open[i].face);
    return false;
  }
  SeamClosing closing(surface, edges, open, rules_, places_, control);
  const bool is_any = !partners.pairs.empty() && closing.run(std::move(partners.pairs));
  // If the edges beside an edge were joined without it, it still counts as an edge with others beside it.
  std::vector<Ends> left_ends;
  for (std::size_t i = 0; i < open.size(); ++i) {
    check();
    const auto source = [&](VertexId v) { return surface.vertex_source[is_any ? closing.image(v) : v]; };
    const Ends before{surface.vertex_source[open[i].from], surface.vertex_source[open[i].to]};
    const bool is_beside = partners.is_beside[i] || std::binary_search(left_ends_.begin(), left_ends_.end(), before);
    if (!open[i].is_open || !is_beside || (is_any && closing.is_closed(open[i].half_edge))) continue;
    add(left_, open[i].face);
    left_ends.push_back({source(open[i].from), source(open[i].to)});
  }
  sort_stoppable(left_ends.begin(), left_ends.end(), control);
  left_ends_ = std::move(left_ends);
  if (!is_any) return false;
  for (const FaceId f : closing.closed()) add(found_, f);
  width_ = std::max(width_, closing.width() * surface.unit);
  is_mended_ = mend == MendMode::kYes;
  if (!is_mended_) return false;
  places_.add(surface, closing.boxes(), control);
  surface.corners.change([&](std::vector<VertexId>& corners) {
    for_blocks(corners.size(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
      for (VertexId& v : std::span(corners).subspan(begin, end - begin)) v = closing.image(v);
    });
  });
  drop_unused_vertices(surface, control);
  return true;
}

void Seams::report(std::vector<Diagnostic>& diagnostics) const {
  constexpr const char* kFaces = "; `elements` lists one face of each edge by number";
  const auto report_found = [&](Diagnostic found, std::string message) {
    if (found.count == 0) return;
    found.code = DiagnosticCode::kSeam;
    found.message = std::move(message);
    diagnostics.push_back(std::move(found));
  };
  report_found(found_, "open edges had a partner beside them, at most " + number_text(width_, 2) +
                           " apart, which the rounding of the coordinates explains, and were " +
                           (is_mended_ ? "joined with it" : "left open") + kFaces);
  report_found(left_,
               std::string(are_too_many_ ? "open edges lie beside each other and were left open: they are too many to "
                                           "look for pairs"
                                         : "open edges run beside other open edges, as near as the rounding of the "
                                           "coordinates explains, and were left open: it is not clear which two belong "
                                           "together, or joining them would damage the surface") +
                   kFaces);
}

}  // namespace remesh
