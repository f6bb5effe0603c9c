#include "core/mending/polygons/degenerate_faces.h"

#include <algorithm>
#include <cstdlib>

#include "core/base/error.h"
#include "core/base/ids.h"
#include "core/base/parallel.h"
#include "core/base/union_find.h"
#include "core/mesh/adjacency.h"

namespace remesh {
namespace {

/// Loops with a few nanoseconds per item check for cancellation once in this many items.
constexpr std::uint32_t kItemsBetweenChecks = 1 << 14;

/// Drops the clusters of one surface.
class ClusterDrop {
 public:
  ClusterDrop(Surface& surface, const std::vector<std::uint8_t>& is_degenerate,
              const std::vector<std::uint8_t>& keep_verbatim, RunControl& control)
      : surface_(surface),
        is_degenerate_(is_degenerate),
        keep_verbatim_(keep_verbatim),
        control_(control),
        edges_(surface.vertex_count(), surface.face_begin, surface.corners, control),
        clusters_(surface.face_count()) {}

  void run() {
    find_clusters();
    sort_vertices();
    find_staying();
    surface_.take_faces(rest());
  }

 private:
  struct Entry {
    std::uint32_t cluster;
    VertexId vertex;
    friend bool operator==(const Entry&, const Entry&) = default;
  };

  /// For collinear points, the lexicographic order is the order along the line.
  bool is_before(const Entry& a, const Entry& b) const {
    if (a.cluster != b.cluster) return a.cluster < b.cluster;
    const Vec3 &p = surface_.positions[a.vertex], &q = surface_.positions[b.vertex];
    return p != q ? p < q : a.vertex < b.vertex;
  }

  void find_clusters() {
    for (std::size_t e = 0; e < edges_.edge_count(); ++e) {
      if (e % kItemsBetweenChecks == 0) control_.check_and_move();
      std::uint32_t first = kNone;
      for (const std::uint32_t h : edges_.half_edges(EdgeId(e))) {
        const std::uint32_t f = edges_.face_of(h).value;
        if (!is_degenerate_[f]) continue;
        if (first != kNone) clusters_.join(first, f);
        first = f;
      }
    }
  }

  /// Lists the vertices of each cluster along its line.
  void sort_vertices() {
    for (std::uint32_t f = 0; f < surface_.face_count(); ++f) {
      if (f % kItemsBetweenChecks == 0) control_.check_and_move();
      if (is_degenerate_[f])
        for (const VertexId v : surface_.face(FaceId(f))) on_line_.push_back({clusters_.find(f), v});
    }
    sort_all(on_line_.begin(), on_line_.end(), [&](const Entry& a, const Entry& b) {
      control_.check();
      return is_before(a, b);
    });
    on_line_.erase(std::unique(on_line_.begin(), on_line_.end()), on_line_.end());
  }

  /// Finds the clusters that would give a vertex to a face that must not get any. These clusters stay.
  void find_staying() {
    stays_.assign(surface_.face_count(), 0);
    for (std::uint32_t f = 0; f < surface_.face_count(); ++f) {
      if (f % kItemsBetweenChecks == 0) control_.check_and_move();
      if (keep_verbatim_.empty() || keep_verbatim_[surface_.face_source[FaceId(f)].value] == 0) continue;
      for (std::uint32_t h = surface_.face_begin[f]; h < surface_.face_begin[f + 1]; ++h)
        if (const std::uint32_t cluster = cluster_beyond(h); cluster != kNone) stays_[cluster] = 1;
    }
  }

  /// Returns the faces that are not dropped, with the vertices that they get from dropped ones.
  FaceList rest() {
    FaceList out;
    std::size_t inserted = 0;
    const std::size_t most = 4 * surface_.corners.size() + 1'000'000;
    for (std::uint32_t f = 0; f < surface_.face_count(); ++f) {
      if (is_degenerate_[f] && !stays_[clusters_.find(f)]) continue;
      for (std::uint32_t h = surface_.face_begin[f]; h < surface_.face_begin[f + 1]; ++h) {
        if (h % kItemsBetweenChecks == 0) control_.check_and_move();
        out.corners.push_back(surface_.corners[h]);
        const std::uint32_t cluster = cluster_beyond(h);
        if (cluster == kNone || stays_[cluster]) continue;
        const auto from = find({cluster, edges_.from(h)}), to = find({cluster, edges_.to(h)});
        inserted += static_cast<std::size_t>(std::abs(to - from));
        if (inserted > most)
          throw Error(Code::kInvalidMesh, Stage::kWeld, "zero-area faces nest too deeply to be mended")
              .at_element(surface_.face_source[FaceId(f)].value);
        if (from < to)
          for (auto it = from + 1; it < to; ++it) out.corners.push_back(it->vertex);
        else
          for (auto it = from; it-- > to + 1;) out.corners.push_back(it->vertex);
      }
      out.face_begin.push_back(static_cast<std::uint32_t>(out.corners.size()));
      out.face_source.push_back(surface_.face_source[FaceId(f)]);
      if (!surface_.face_label.empty()) out.face_label.push_back(surface_.face_label[FaceId(f)]);
    }
    return out;
  }

  std::vector<Entry>::const_iterator find(const Entry& entry) const {
    return std::lower_bound(on_line_.begin(), on_line_.end(), entry,
                            [&](const Entry& a, const Entry& b) { return is_before(a, b); });
  }

  /// Returns the cluster that has a face at the edge of a half-edge, or kNone.
  std::uint32_t cluster_beyond(std::uint32_t half_edge) {
    for (const std::uint32_t h : edges_.half_edges(edges_.edge_of(half_edge)))
      if (is_degenerate_[edges_.face_of(h).value]) return clusters_.find(edges_.face_of(h).value);
    return kNone;
  }

  Surface& surface_;
  const std::vector<std::uint8_t>& is_degenerate_;
  const std::vector<std::uint8_t>& keep_verbatim_;
  RunControl& control_;
  const Adjacency edges_;
  UnionFind clusters_;               ///< a cluster has the number of one of its faces
  std::vector<Entry> on_line_;       ///< the vertices of each cluster along its line
  std::vector<std::uint8_t> stays_;  ///< by cluster
};

}  // namespace

void drop_degenerate_faces(Surface& surface, const std::vector<std::uint8_t>& is_degenerate,
                           const std::vector<std::uint8_t>& keep_verbatim, RunControl& control) {
  ClusterDrop(surface, is_degenerate, keep_verbatim, control).run();
}

}  // namespace remesh
