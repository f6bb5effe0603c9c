#include "core/mesh/adjacency.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <utility>

namespace remesh {
namespace {

/// Vertices whose edges are put in order in one go.
constexpr std::size_t kBlock = 4096;

/// Puts the half-edges of one smaller vertex in the order of the larger one.
template <class Larger>
void sort_bucket(std::span<std::uint32_t> bucket, std::vector<std::pair<std::uint32_t, std::uint32_t>>& keys,
                 const Larger& larger) {
  keys.clear();
  for (const std::uint32_t h : bucket) keys.push_back({larger(h), h});
  std::sort(keys.begin(), keys.end());
  std::transform(keys.begin(), keys.end(), bucket.begin(), [](const auto& key) { return key.second; });
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
  std::vector<std::uint32_t> bucket(vertex_count + 1, 0);
  group_by_smaller_vertex(bucket);
  number_edges(bucket);
}

/// A counting sort. `bucket`: where in `half_edges_` the half-edges of each vertex begin.
void Adjacency::group_by_smaller_vertex(std::vector<std::uint32_t>& bucket) {
  const auto smaller = [&](std::uint32_t h) { return std::min(from(h), to(h)).value; };
  const auto n = static_cast<std::uint32_t>(corners_.size());
  for (std::uint32_t h = 0; h < n; ++h) ++bucket[smaller(h) + 1];
  for (std::size_t v = 0; v + 1 < bucket.size(); ++v) bucket[v + 1] += bucket[v];
  std::vector<std::uint32_t> at(bucket.begin(), bucket.end() - 1);
  half_edges_.resize(n);
  for (std::uint32_t h = 0; h < n; ++h) half_edges_[at[smaller(h)]++] = h;
}

void Adjacency::number_edges(const std::vector<std::uint32_t>& bucket) {
  const auto larger = [&](std::uint32_t h) { return std::max(from(h), to(h)).value; };
  const std::size_t vertices = bucket.size() - 1;
  const std::size_t blocks = (vertices + kBlock - 1) / kBlock;
  const auto is_first = [&](std::uint32_t begin, std::uint32_t i) {
    return i == begin || larger(half_edges_[i]) != larger(half_edges_[i - 1]);
  };
  // Each block of vertices for itself, to know how many edges are before the next one; then all are numbered.
  std::vector<std::uint32_t> edges_before(blocks + 1, 0);
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> keys;
    std::uint32_t edges = 0;
    for (std::size_t v = block * kBlock; v < std::min(vertices, (block + 1) * kBlock); ++v) {
      sort_bucket(std::span(half_edges_).subspan(bucket[v], bucket[v + 1] - bucket[v]), keys, larger);
      for (std::size_t i = 0; i < keys.size(); ++i) edges += i == 0 || keys[i].first != keys[i - 1].first;
    }
    edges_before[block + 1] = edges;
  });
  for (std::size_t block = 0; block < blocks; ++block) edges_before[block + 1] += edges_before[block];
  edge_begin_.resize(edges_before.back() + 1);
  edge_begin_.back() = static_cast<std::uint32_t>(corners_.size());
  twin_.resize(corners_.size());
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
    std::uint32_t edge = edges_before[block];
    for (std::size_t v = block * kBlock; v < std::min(vertices, (block + 1) * kBlock); ++v) {
      for (std::uint32_t begin = bucket[v], end = begin; begin < bucket[v + 1]; begin = end, ++edge) {
        edge_begin_[edge] = begin;
        for (end = begin + 1; end < bucket[v + 1] && !is_first(begin, end);) ++end;
        for (std::uint32_t i = begin; i < end; ++i) twin_[half_edges_[i]] = kNone;
        const std::uint32_t g = half_edges_[begin], h = half_edges_[end - 1];
        if (end - begin == 2 && corners_[g] != corners_[h]) {
          twin_[g] = h;
          twin_[h] = g;
        }
      }
    }
  });
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
