#include "core/mending/seams.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <tuple>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/parallel.h"
#include "core/base/tolerance.h"
#include "core/mending/open_edges.h"
#include "core/mesh/unused_vertices.h"

namespace remesh {
namespace {

constexpr std::size_t kBlock = 256;
constexpr std::uint32_t kBetweenChecks = 4096;

/// Two open edges, by their numbers, and how far they are apart.
struct Pair {
  std::size_t i, j;
  double width;
};

struct Partners {
  std::vector<Pair> pairs;
  bool is_complete = true;  ///< false: there were too many to look at
};

/// The pairs of edges that are partners of each other and of nobody else.
Partners find_partners(const OpenEdges& open, double tolerance, RunControl& control) {
  constexpr std::uint32_t kNone = 0xffffffffu, kSeveral = 0xfffffffeu;
  const auto is_worth_a_look = [&](const OpenEdge& edge) {
    return edge.length > 2 * tolerance && edge.height > kThinFace * tolerance;
  };
  LooksAtEdges looks(open.size());
  const auto blocks =
      map_blocks<std::vector<std::uint32_t>>(open.size(), kBlock, control, [&](std::size_t begin, std::size_t end) {
        std::vector<std::uint32_t> partners(end - begin, kNone);
        // So that what is exactly as far is found, rounding of the middles included.
        const double radius = tolerance * (1 + 1e-6) + 1e-300;
        for (std::size_t i = begin; i < end && !looks.are_too_many(); ++i) {
          if (!is_worth_a_look(open[i])) continue;
          std::uint32_t& partner = partners[i - begin];
          looks.add(open.search(i, radius, control, [&](std::uint32_t j) {
            if (!is_worth_a_look(open[j]) || !(open.width(i, j, tolerance) <= tolerance)) return;
            partner = partner == kNone ? j : kSeveral;
          }));
        }
        return partners;
      });
  Partners found;
  found.is_complete = !looks.are_too_many();
  if (!found.is_complete) return found;
  const auto partner = concatenate<std::uint32_t>(blocks, control);
  for (std::uint32_t i = 0; i < partner.size(); ++i) {
    if (i % kBetweenChecks == 0) control.check();
    if (partner[i] < kSeveral && i < partner[i] && partner[partner[i]] == i)
      found.pairs.push_back({i, partner[i], open.width(i, partner[i], tolerance)});
  }
  return found;
}

/// Vertices that become one. Only those at the ends of partners are known here.
class Clusters {
 public:
  Clusters(const Surface& surface, std::vector<VertexId> vertices, RunControl& control)
      : surface_(surface), vertices_(std::move(vertices)) {
    sort_all(vertices_.begin(), vertices_.end(), [&](VertexId a, VertexId b) {
      control.check();
      return a < b;
    });
    vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
    clusters_.reserve(vertices_.size());
    for (std::uint32_t k = 0; k < vertices_.size(); ++k) {
      if (k % kBetweenChecks == 0) control.check();
      const Vec3& place = surface.local[vertices_[k]];
      clusters_.push_back({k, 1, vertices_[k], {place, place}});
    }
  }

  /// Whether all would lie in a box with a diagonal of at most `limit` if both were one.
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

  /// Calls visit(vertex, the one that it becomes) for all those in clusters of two or more.
  template <class Visit>
  void for_each_joined(const Visit& visit) const {
    for (std::uint32_t k = 0; k < vertices_.size(); ++k) {
      const Cluster& cluster = clusters_[root(k)];
      if (cluster.size > 1) visit(vertices_[k], cluster.least);
    }
  }

 private:
  struct Cluster {
    std::uint32_t parent, size;
    VertexId least;  ///< of its vertices, the one with the least place
    Box3 box;
  };

  std::uint32_t number(VertexId v) const {
    return static_cast<std::uint32_t>(std::lower_bound(vertices_.begin(), vertices_.end(), v) - vertices_.begin());
  }
  // Joined by size: no longer than the logarithm.
  std::uint32_t root(std::uint32_t k) const {
    while (clusters_[k].parent != k) k = clusters_[k].parent;
    return k;
  }

  const Surface& surface_;
  std::vector<VertexId> vertices_;
  std::vector<Cluster> clusters_;
};

class Closing {
 public:
  Closing(const Surface& surface, const Adjacency& edges, const OpenEdges& open, double tolerance, RunControl& control)
      : surface_(surface), edges_(edges), open_(open), tolerance_(tolerance), control_(control) {}

  /// Finds which vertices become one. Output: false if none do.
  bool run(std::vector<Pair> pairs) {
    // The nearest first: whoever comes later joins only if the cluster stays within the tolerance.
    sort_all(pairs.begin(), pairs.end(), [&](const Pair& a, const Pair& b) {
      control_.check();
      if (a.width != b.width) return a.width < b.width;
      const auto first = [&](const Pair& p) { return open_.is_before(p.i, p.j) ? p.i : p.j; };
      return open_.is_before(first(a), first(b));
    });
    pairs_ = std::move(pairs);
    choose_pairs();
    // A pair that is left out makes clusters smaller, which spoils nothing that was sound: at the second look all are
    // sound.
    while (!pairs_.empty()) {
      look();
      if (spoilt_.empty()) return true;
      const auto is_spoilt = [&](VertexId v) { return std::binary_search(spoilt_.begin(), spoilt_.end(), image_[v]); };
      pairs_.erase(
          std::remove_if(pairs_.begin(), pairs_.end(),
                         [&](const Pair& p) { return is_spoilt(open_[p.i].from) || is_spoilt(open_[p.i].to); }),
          pairs_.end());
    }
    return false;
  }

  VertexId image(VertexId v) const { return image_[v]; }
  /// A face at each edge that closes.
  const std::vector<FaceId>& closed() const { return closed_; }
  double width() const {
    double width = 0;
    for (const Pair& pair : pairs_) width = std::max(width, pair.width);
    return width;
  }

 private:
  /// An edge of which an end becomes one with another vertex.
  struct Moved {
    VertexId low, high;  ///< of its new ends
    VertexId old_low, old_high;
    std::uint32_t half_edge;
    bool is_forward;  ///< from low to high

    auto ends() const { return std::tuple(low, high); }
    bool is_same_edge(const Moved& other) const { return old_low == other.old_low && old_high == other.old_high; }
    friend bool operator<(const Moved& a, const Moved& b) {
      return std::tie(a.low, a.high, a.old_low, a.old_high, a.half_edge) <
             std::tie(b.low, b.high, b.old_low, b.old_high, b.half_edge);
    }
  };

  Clusters make_clusters() const {
    std::vector<VertexId> ends;
    ends.reserve(4 * pairs_.size());
    for (const Pair& p : pairs_)
      for (const std::size_t k : {p.i, p.j}) ends.insert(ends.end(), {open_[k].from, open_[k].to});
    return Clusters(surface_, std::move(ends), control_);
  }

  /// Drops the pairs with an end whose cluster would be larger than the tolerance.
  void choose_pairs() {
    Clusters clusters = make_clusters();
    std::uint32_t looks = 0;
    const auto is_refused = [&](const Pair& p) {
      if (looks++ % kBetweenChecks == 0) control_.check();
      const OpenEdge &a = open_[p.i], &b = open_[p.j];
      // The edges are longer than any cluster, so that what happens at one end is nothing to the other.
      const double limit = tolerance_ * (1 + 1e-9);
      if (!clusters.can_join(a.from, b.to, limit) || !clusters.can_join(a.to, b.from, limit)) return true;
      clusters.join(a.from, b.to);
      clusters.join(a.to, b.from);
      return false;
    };
    std::vector<Pair> chosen;
    for (const Pair& p : pairs_)
      if (!is_refused(p)) chosen.push_back(p);
    pairs_ = std::move(chosen);
  }

  /// Joins the ends of the pairs and looks at what comes of it: which edges close, and which vertices would spoil
  /// something.
  void look() {
    Clusters clusters = make_clusters();
    std::uint32_t looks = 0;
    for (const Pair& p : pairs_) {
      if (looks++ % kBetweenChecks == 0) control_.check();
      clusters.join(open_[p.i].from, open_[p.j].to);
      clusters.join(open_[p.i].to, open_[p.j].from);
    }
    image_ = FilledIdVector<VertexId, VertexId>::of_size(surface_.vertex_count());
    is_joined_.assign(surface_.vertex_count(), 0);
    for (std::uint32_t v = 0; v < image_.size(); ++v) {
      if (v % kBetweenChecks == 0) control_.check();
      image_[VertexId(v)] = VertexId(v);
    }
    clusters.for_each_joined([&](VertexId v, VertexId least) {
      image_[v] = least;
      is_joined_[v.value] = 1;
    });
    spoilt_.clear();
    closed_.clear();
    look_at_edges(moved_edges());
    sort_all(spoilt_.begin(), spoilt_.end());
    spoilt_.erase(std::unique(spoilt_.begin(), spoilt_.end()), spoilt_.end());
  }

  /// The edges of which an end is one with another vertex, in order. Notes what of their faces collapses.
  std::vector<Moved> moved_edges() {
    std::vector<Moved> moved;
    const auto is_joined = [&](VertexId v) { return is_joined_[v.value] != 0; };
    for (std::uint32_t f = 0; f < surface_.face_count(); ++f) {
      if (f % kBetweenChecks == 0) control_.check();
      const auto loop = surface_.face(FaceId(f));
      if (std::none_of(loop.begin(), loop.end(), is_joined)) continue;
      if (does_collapse(loop))
        for (const VertexId v : loop)
          if (is_joined(v)) spoilt_.push_back(image_[v]);
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const VertexId from = loop[i], to = loop[i + 1 == loop.size() ? 0 : i + 1];
        if (!is_joined(from) && !is_joined(to)) continue;
        const VertexId a = image_[from], b = image_[to];
        if (a == b) continue;  // the corner of a polygon that is there twice; or one that collapses has been noted
        const auto half_edge = static_cast<std::uint32_t>(surface_.face_begin[f] + i);
        moved.push_back({std::min(a, b), std::max(a, b), std::min(from, to), std::max(from, to), half_edge, a < b});
      }
    }
    sort_all(moved.begin(), moved.end(), [&](const Moved& a, const Moved& b) {
      control_.check();
      return a < b;
    });
    return moved;
  }

  /// Whether a face with joined corners has lost more than corners that repeat their neighbours.
  bool does_collapse(std::span<const VertexId> loop) {
    loop_.clear();
    for (const VertexId v : loop)
      if (loop_.empty() || loop_.back() != image_[v]) loop_.push_back(image_[v]);
    while (loop_.size() > 1 && loop_.front() == loop_.back()) loop_.pop_back();
    if (loop_.size() == loop.size() && loop.size() == 3) return false;
    const std::size_t left = loop_.size();
    std::sort(loop_.begin(), loop_.end());
    const auto different = static_cast<std::size_t>(std::unique(loop_.begin(), loop_.end()) - loop_.begin());
    // A triangle that loses a corner is gone. A quadrilateral with two opposite corners in one place is a spike.
    return loop.size() == 3 || left < 3 || different < 3;
  }

  /// Input: edges in order. Those that come to lie on each other close if they are two open ones that run in opposite
  /// directions; all else would not be a surface.
  void look_at_edges(std::span<const Moved> moved) {
    for (std::size_t begin = 0, end = 0; begin < moved.size(); begin = end) {
      if (begin % kBetweenChecks == 0) control_.check();
      bool are_one = true;
      for (end = begin + 1; end < moved.size() && moved[end].ends() == moved[begin].ends(); ++end)
        are_one = are_one && moved[end].is_same_edge(moved[begin]);
      if (are_one) continue;
      if (end - begin == 2 && moved[begin].is_forward != moved[begin + 1].is_forward) {
        const FaceId f = edges_.face_of(moved[begin].half_edge), g = edges_.face_of(moved[begin + 1].half_edge);
        closed_.push_back(std::min(f, g));
        continue;
      }
      for (const VertexId v : {moved[begin].low, moved[begin].high})
        if (is_joined_[v.value]) spoilt_.push_back(v);
    }
  }

  const Surface& surface_;
  const Adjacency& edges_;
  const OpenEdges& open_;
  double tolerance_;
  RunControl& control_;
  std::vector<Pair> pairs_;
  FilledIdVector<VertexId, VertexId> image_;  ///< what each vertex becomes
  std::vector<std::uint8_t> is_joined_;       ///< with another vertex
  std::vector<VertexId> spoilt_;              ///< images that must not be
  std::vector<FaceId> closed_;
  std::vector<VertexId> loop_;
};

Diagnostic told(const Surface& surface, std::span<const FaceId> faces, std::string message) {
  Diagnostic found{DiagnosticCode::kSeam, 0, {}, std::move(message)};
  for (const FaceId f : faces) found.add(surface.face_source[f].value);
  return found;
}

}  // namespace

bool close_seams(Surface& surface, const Adjacency& edges, double tolerance, Mend mend,
                 std::vector<Diagnostic>& diagnostics, RunControl& control) {
  if (edges.odd_edges().empty()) return false;
  const OpenEdges open(surface, edges, control);
  if (open.size() < 2) return false;
  Partners partners = find_partners(open, tolerance, control);
  if (!partners.is_complete) {
    std::vector<FaceId> faces;
    for (std::size_t i = 0; i < open.size(); ++i) faces.push_back(open[i].face);
    diagnostics.push_back(told(surface, faces,
                               "open edges lie beside each other, so many that no seam was looked for; elements are "
                               "faces"));
    return false;
  }
  Closing closing(surface, edges, open, tolerance, control);
  if (partners.pairs.empty() || !closing.run(std::move(partners.pairs))) return false;
  const std::string apart = ", up to " + few_digits(closing.width() * surface.unit) + " apart";
  const std::string where = "open edges had a partner beside them within the rounding of the coordinates" + apart;
  if (mend == Mend::kNo) {
    diagnostics.push_back(told(surface, closing.closed(), where + ", and were left open; elements are faces"));
    return false;
  }
  diagnostics.push_back(told(surface, closing.closed(), where + ", and were joined with it; elements are faces"));
  surface.corners.change([&](std::vector<VertexId>& corners) {
    for_blocks(corners.size(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
      for (VertexId& v : std::span(corners).subspan(begin, end - begin)) v = closing.image(v);
    });
  });
  drop_unused_vertices(surface, control);
  return true;
}

}  // namespace remesh
