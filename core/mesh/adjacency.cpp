#include "core/mesh/adjacency.h"

#include <array>
#include <atomic>
#include <cstddef>
#include <numeric>

#include "core/base/blocks.h"
#include "core/base/grouping.h"
#include "core/base/prefault_pages.h"
#include "core/base/sort_few.h"

namespace remesh {
namespace {

/// The number of vertices whose edges are sorted together.
constexpr std::size_t kVertices = 1024;

/// A single vertex may have millions of edges. Work on them checks for cancellation once in this many.
constexpr std::size_t kBetweenChecks = 1 << 16;

/// Returns whether all edges between a vertex and larger ones have two half-edges in opposite directions. `forward` has
/// the keys, in order, of the half-edges that run from the vertex to larger ones, and `backward` those of the
/// half-edges that run to it.
bool are_pairs(std::span<const std::uint64_t> forward, std::span<const std::uint64_t> backward) {
  if (forward.size() != backward.size()) return false;
  for (std::size_t i = 0; i < forward.size(); ++i)
    if (forward[i] >> 32 != backward[i] >> 32 || (i > 0 && forward[i] >> 32 == forward[i - 1] >> 32)) return false;
  return true;
}

}  // namespace

Adjacency::Adjacency(std::size_t vertex_count, std::span<const std::uint32_t> face_begin,
                     std::span<const VertexId> corners, RunControl& control)
    : face_begin_(face_begin), corners_(corners) {
  std::atomic<bool> are_triangles = true;
  for_blocks(face_begin.size(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
    bool are_here = true;
    for (std::size_t f = begin; f < end; ++f) are_here &= face_begin[f] == 3 * f;
    if (!are_here) are_triangles = false;
  });
  are_triangles_ = are_triangles;
  if (!are_triangles_) {
    face_of_.resize(corners.size());
    for_blocks(face_begin.size() - 1, kItemsPerBlock, control, [&](std::size_t f, std::size_t end) {
      for (; f < end; ++f)
        for (std::uint32_t h = face_begin[f]; h < face_begin[f + 1]; ++h) face_of_[h] = FaceId(f);
    });
  }

  // The half-edges are first grouped into parts of `kVertices` smaller vertices each. Then each part is sorted on its
  // own.
  const std::size_t parts = (vertex_count + kVertices - 1) / kVertices;
  Grouping by_part = group_by(
      corners.size(), parts, [&](std::uint32_t h) { return smaller(h).value / kVertices; }, control);
  half_edges_ = std::move(by_part.items);
  twin_.resize(corners.size());
  constexpr std::size_t kManyItems = std::size_t{1} << 18;
  for_blocks(corners.size(), kManyItems, control,
             [&](std::size_t begin, std::size_t end) { prefault_pages(std::span(twin_).subspan(begin, end - begin)); });
  std::vector<std::uint32_t> edges_before(parts + 1, 0);
  for_blocks(parts, 1, control, [&](std::size_t part, std::size_t) {
    const std::uint32_t begin = by_part.begin[part], end = by_part.begin[part + 1];
    const std::size_t first = part * kVertices, vertices = std::min(kVertices, vertex_count - first);
    edges_before[part + 1] = sort_part(first, vertices, std::span(half_edges_).subspan(begin, end - begin), control);
  });
  // After the sum, each entry is the number of edges before its part.
  std::partial_sum(edges_before.begin(), edges_before.end(), edges_before.begin());
  edge_begin_.resize(edges_before.back() + 1);
  edge_begin_.back() = static_cast<std::uint32_t>(corners.size());
  for (const auto& of_part : map_blocks<std::vector<EdgeId>>(parts, 1, control, [&](std::size_t part, std::size_t) {
         return number_edges(edges_before[part], by_part.begin[part], by_part.begin[part + 1], control);
       }))
    odd_edges_.insert(odd_edges_.end(), of_part.begin(), of_part.end());
}

/// Sorts half-edges so that those of the same edge are next to each other, and finds their twins.
/// Input:  The numbers of the half-edges are ascending. The smaller vertex of each half-edge is one of the kVertices or
///         fewer vertices that begin with `first`.
/// Output: The number of edges of these half-edges.
std::uint32_t Adjacency::sort_part(std::size_t first, std::size_t vertices, std::span<std::uint32_t> half_edges,
                                   RunControl& control) {
  // This is a counting sort by the smaller vertex and by direction, and then a small sort by the larger vertex in each
  // bucket. A small mesh uses only as many entries of the table as it has vertices.
  std::array<std::uint32_t, 2 * kVertices + 1> table;
  const std::span<std::uint32_t> place = std::span(table).first(2 * vertices + 1);
  std::fill(place.begin(), place.end(), 0);
  using Keys = std::vector<std::uint64_t, DefaultInit<std::uint64_t>>;
  // A key has the larger vertex in its upper half and the half-edge in its lower half.
  Keys gathered(half_edges.size()), keys(half_edges.size());
  std::vector<std::uint16_t, DefaultInit<std::uint16_t>> bucket(half_edges.size());
  static_assert(2 * kVertices <= 1 << 16);
  for (std::size_t i = 0; i < half_edges.size(); ++i) {
    if (i % kBetweenChecks == 0) control.check_and_move();
    const std::uint32_t h = half_edges[i];
    const VertexId a = from(h), b = to(h);
    gathered[i] = std::uint64_t{std::max(a, b).value} << 32 | h;
    bucket[i] = static_cast<std::uint16_t>(2 * (std::min(a, b).value - first) + (a < b ? 0u : 1u));
    ++place[bucket[i] + 1u];
  }
  std::partial_sum(place.begin(), place.end(), place.begin());
  for (std::size_t i = 0; i < gathered.size(); ++i) {
    if (i % kBetweenChecks == 0) control.check_and_move();
    keys[place[bucket[i]]++] = gathered[i];
  }
  std::uint32_t edges = 0;
  const std::span<std::uint64_t> all(keys), sorted(gathered);
  for (std::size_t v = 0, begin = 0; begin < half_edges.size(); ++v) {
    control.check();
    const std::size_t middle = place[2 * v], end = place[2 * v + 1];
    const auto forward = sorted.subspan(begin, middle - begin), backward = sorted.subspan(middle, end - middle);
    sort_few(all.subspan(begin, forward.size()), forward, control);
    sort_few(all.subspan(middle, backward.size()), backward, control);
    if (are_pairs(forward, backward)) {  // the usual case
      for (std::size_t i = 0; i < forward.size(); ++i) {
        const auto g = static_cast<std::uint32_t>(forward[i]), h = static_cast<std::uint32_t>(backward[i]);
        half_edges[begin + 2 * i] = std::min(g, h);
        half_edges[begin + 2 * i + 1] = std::max(g, h);
        twin_[g] = h;
        twin_[h] = g;
      }
      edges += static_cast<std::uint32_t>(forward.size());
    } else {
      const auto both = sorted.subspan(begin, end - begin);
      sort_few(all.subspan(begin, end - begin), both, control);
      for (std::size_t i = 0, next; i < both.size(); i = next, ++edges) {
        for (next = i + 1; next < both.size() && both[next] >> 32 == both[i] >> 32;) ++next;
        join_edge(both.subspan(i, next - i), &half_edges[begin + i]);
      }
    }
    begin = end;
  }
  return edges;
}

/// Stores the half-edges of one edge, given by their keys, and whether they are twins.
void Adjacency::join_edge(std::span<const std::uint64_t> edge, std::uint32_t* half_edges) {
  for (std::size_t i = 0; i < edge.size(); ++i) {
    half_edges[i] = static_cast<std::uint32_t>(edge[i]);
    twin_[half_edges[i]] = kNone;
  }
  if (edge.size() != 2 || corners_[half_edges[0]] == corners_[half_edges[1]]) return;
  twin_[half_edges[0]] = half_edges[1];
  twin_[half_edges[1]] = half_edges[0];
}

/// Sets where each edge begins, for the half-edges from `begin` to `end`, whose first edge is number `edge`. Returns
/// the edges without twins.
std::vector<EdgeId> Adjacency::number_edges(std::uint32_t edge, std::uint32_t begin, std::uint32_t end,
                                            RunControl& control) {
  const auto is_same = [&](std::uint32_t g, std::uint32_t h) {
    return smaller(g) == smaller(h) && larger(g) == larger(h);
  };
  std::vector<EdgeId> odd;
  for (std::uint32_t next = begin; begin < end; begin = next, ++edge) {
    if (edge % kBetweenChecks == 0) control.check_and_move();
    edge_begin_[edge] = begin;
    next = begin + 2;
    if (twin_[half_edges_[begin]] != kNone) continue;  // the usual case: the edge has just these two half-edges
    for (next = begin + 1; next < end && is_same(half_edges_[begin], half_edges_[next]);) ++next;
    odd.push_back(EdgeId(edge));
  }
  return odd;
}

EdgeId Adjacency::find(VertexId a, VertexId b) const {
  const auto ends = [&](std::uint32_t begin) {
    const std::uint32_t h = half_edges_[begin];
    return std::minmax({from(h), to(h)});
  };
  const std::pair<VertexId, VertexId> wanted = std::minmax(a, b);
  const auto last = edge_begin_.end() - 1;
  const auto found =
      std::partition_point(edge_begin_.begin(), last, [&](std::uint32_t begin) { return ends(begin) < wanted; });
  if (found == last || ends(*found) != wanted) return {};
  return EdgeId(static_cast<std::size_t>(found - edge_begin_.begin()));
}

}  // namespace remesh
