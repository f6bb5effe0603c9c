#include "core/mesh/adjacency.h"

#include <algorithm>
#include <utility>

namespace remesh {

Adjacency::Adjacency(std::size_t vertex_count, std::span<const std::uint32_t> face_begin,
                     std::span<const VertexId> corners)
    : face_begin_(face_begin), corners_(corners) {
  const std::size_t n = corners.size();
  face_of_.resize(n);
  for (std::size_t f = 0; f + 1 < face_begin.size(); ++f)
    for (std::uint32_t h = face_begin[f]; h < face_begin[f + 1]; ++h) face_of_[h] = FaceId(f);

  // Counting sort by the smaller vertex, then a small sort by the larger one within each bucket.
  std::vector<std::uint32_t> bucket(vertex_count + 1, 0);
  const auto smaller = [&](std::uint32_t h) { return std::min(from(h), to(h)).value; };
  const auto larger = [&](std::uint32_t h) { return std::max(from(h), to(h)).value; };
  for (std::uint32_t h = 0; h < n; ++h) ++bucket[smaller(h) + 1];
  for (std::size_t v = 0; v < vertex_count; ++v) bucket[v + 1] += bucket[v];
  std::vector<std::pair<std::uint32_t, std::uint32_t>> sorted(n);  // (larger vertex, half-edge)
  {
    std::vector<std::uint32_t> at(bucket.begin(), bucket.end() - 1);
    for (std::uint32_t h = 0; h < n; ++h) sorted[at[smaller(h)]++] = {larger(h), h};
  }
  half_edges_.resize(n);
  edge_of_.resize(n);
  edge_begin_.reserve(n / 2 + 2);
  for (std::size_t v = 0; v < vertex_count; ++v) {
    const auto begin = sorted.begin() + bucket[v];
    const auto end = sorted.begin() + bucket[v + 1];
    std::sort(begin, end);
    for (auto it = begin; it != end; ++it) {
      if (it == begin || it->first != (it - 1)->first)
        edge_begin_.push_back(static_cast<std::uint32_t>(it - sorted.begin()));
      half_edges_[it - sorted.begin()] = it->second;
      edge_of_[it->second] = EdgeId(edge_begin_.size() - 1);
    }
  }
  edge_begin_.push_back(static_cast<std::uint32_t>(n));
}

EdgeId Adjacency::find(VertexId a, VertexId b) const {
  const std::pair sought(std::min(a, b), std::max(a, b));
  const auto ends = [&](std::uint32_t e) {
    const std::uint32_t h = half_edges_[edge_begin_[e]];
    return std::pair(std::min(from(h), to(h)), std::max(from(h), to(h)));
  };
  std::uint32_t low = 0;
  for (auto high = static_cast<std::uint32_t>(edge_count()); low < high;) {
    const std::uint32_t middle = low + (high - low) / 2;
    if (ends(middle) < sought)
      low = middle + 1;
    else
      high = middle;
  }
  return low < edge_count() && ends(low) == sought ? EdgeId(low) : EdgeId();
}

}  // namespace remesh
