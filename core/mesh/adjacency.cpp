#include "core/mesh/adjacency.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <utility>

#include "core/base/grouping.h"
#include "core/base/parallel.h"
#include "core/base/run_control.h"

namespace remesh {
namespace {

/// Vertices whose edges are put in order in one go.
constexpr std::size_t kVertices = 1024;

/// Few numbers, as most often, without a call.
void sort(std::span<std::uint64_t> keys) {
  constexpr std::size_t kFew = 16;
  if (keys.size() > kFew) return std::sort(keys.begin(), keys.end());
  for (std::size_t i = 1; i < keys.size(); ++i) {
    const std::uint64_t key = keys[i];
    std::size_t j = i;
    for (; j > 0 && keys[j - 1] > key; --j) keys[j] = keys[j - 1];
    keys[j] = key;
  }
}

}  // namespace

Adjacency::Adjacency(std::size_t vertex_count, std::span<const std::uint32_t> face_begin,
                     std::span<const VertexId> corners)
    : face_begin_(face_begin), corners_(corners) {
  for (std::size_t f = 0; f < face_begin.size() && are_triangles_; ++f) are_triangles_ = face_begin[f] == 3 * f;
  if (!are_triangles_) {
    face_of_.resize(corners.size());
    for (std::size_t f = 0; f + 1 < face_begin.size(); ++f)
      for (std::uint32_t h = face_begin[f]; h < face_begin[f + 1]; ++h) face_of_[h] = FaceId(f);
  }

  // First by parts of so many smaller vertices, then each part for itself.
  const std::size_t parts = (vertex_count + kVertices - 1) / kVertices;
  RunControl never_stopped;
  Grouping by_part = group_by(
      corners.size(), parts, [&](std::uint32_t h) { return smaller(h).value / kVertices; }, never_stopped);
  half_edges_ = std::move(by_part.items);
  std::vector<std::uint32_t> edges_before(parts + 1, 0);
  for_all(std::size_t{0}, parts, [&](std::size_t part) {
    const std::uint32_t begin = by_part.begin[part], end = by_part.begin[part + 1];
    edges_before[part + 1] = sort_part(part * kVertices, std::span(half_edges_).subspan(begin, end - begin));
  });
  // How many edges are before each part is known now.
  std::partial_sum(edges_before.begin(), edges_before.end(), edges_before.begin());
  edge_begin_.resize(edges_before.back() + 1);
  edge_begin_.back() = static_cast<std::uint32_t>(corners.size());
  twin_.resize(corners.size());
  for_all(std::size_t{0}, parts,
          [&](std::size_t part) { number_edges(edges_before[part], by_part.begin[part], by_part.begin[part + 1]); });
}

/// Puts half-edges, ascending, whose smaller vertices are the kVertices from `first` on in the order of their edges.
/// Returns how many edges they are.
std::uint32_t Adjacency::sort_part(std::size_t first, std::span<std::uint32_t> half_edges) const {
  // A counting sort by the smaller vertex, then a small sort by the larger one within each bucket.
  std::array<std::uint32_t, kVertices + 1> place{};
  for (const std::uint32_t h : half_edges) ++place[smaller(h).value - first + 1];
  std::partial_sum(place.begin(), place.end(), place.begin());
  std::vector<std::uint64_t> keys(half_edges.size());  // the larger vertex and the half-edge
  for (const std::uint32_t h : half_edges)
    keys[place[smaller(h).value - first]++] = std::uint64_t{larger(h).value} << 32 | h;
  std::uint32_t edges = 0;
  for (std::size_t v = 0, begin = 0; v < kVertices; ++v) {
    const std::span<std::uint64_t> bucket = std::span(keys).subspan(begin, place[v] - begin);
    sort(bucket);
    for (std::size_t i = 0; i < bucket.size(); ++i) {
      edges += i == 0 || bucket[i] >> 32 != bucket[i - 1] >> 32;
      half_edges[begin + i] = static_cast<std::uint32_t>(bucket[i]);
    }
    begin = place[v];
  }
  return edges;
}

/// Of the half-edges from `begin` to `end`, whose first edge is `edge`.
void Adjacency::number_edges(std::uint32_t edge, std::uint32_t begin, std::uint32_t end) {
  const auto is_same = [&](std::uint32_t g, std::uint32_t h) {
    return smaller(g) == smaller(h) && larger(g) == larger(h);
  };
  for (std::uint32_t next = begin; begin < end; begin = next, ++edge) {
    edge_begin_[edge] = begin;
    for (next = begin + 1; next < end && is_same(half_edges_[begin], half_edges_[next]);) ++next;
    for (std::uint32_t i = begin; i < next; ++i) twin_[half_edges_[i]] = kNone;
    const std::uint32_t g = half_edges_[begin], h = half_edges_[next - 1];
    if (next - begin == 2 && corners_[g] != corners_[h]) {
      twin_[g] = h;
      twin_[h] = g;
    }
  }
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
