#include "core/verify/edge_table.h"

#include <algorithm>
#include <array>

#include "core/base/blocks.h"
#include "core/base/grouping.h"

namespace remesh::verification {
namespace {

constexpr std::size_t kVerticesOfPart = 1024;

/// Puts uses in order that are by half-edge already. Few of them, as most often, each by how many come before it: no
/// branch on what nobody can foresee.
void put_in_order(std::span<const Use> uses, std::span<Use> sorted) {
  constexpr std::size_t kFew = 16;
  if (uses.size() > kFew) {
    std::copy(uses.begin(), uses.end(), sorted.begin());
    return std::sort(sorted.begin(), sorted.end());
  }
  std::array<std::uint64_t, kFew> key;
  std::array<std::uint32_t, kFew> rank;
  for (std::size_t i = 0; i < uses.size(); ++i) {
    key[i] = std::uint64_t{uses[i].high.value} << 32 | uses[i].patch().value;
    rank[i] = 0;
    for (std::size_t j = 0; j < i; ++j) {
      const std::uint32_t is_after = key[j] <= key[i];
      rank[i] += is_after;
      rank[j] += 1 - is_after;
    }
  }
  for (std::size_t i = 0; i < uses.size(); ++i) sorted[rank[i]] = uses[i];
}

}  // namespace

bool have_same_uses(std::span<const Use> a, std::span<const Use> b, bool is_flipped) {
  if (a.size() != b.size()) return false;
  for (std::size_t begin = 0; begin < a.size();) {
    const PatchId patch = a[begin].patch();
    std::size_t end = begin;
    std::size_t forward_a = 0, forward_b = 0;
    for (; end < a.size() && a[end].patch() == patch; ++end) {
      if (b[end].patch() != patch) return false;
      forward_a += a[end].is_forward();
      forward_b += b[end].is_forward();
    }
    if (forward_a != (is_flipped ? end - begin - forward_b : forward_b)) return false;
    begin = end;
  }
  return true;
}

bool has_patch(std::span<const Use> uses, PatchId patch) {
  const auto found =
      std::partition_point(uses.begin(), uses.end(), [patch](const Use& u) { return u.patch() < patch; });
  return found != uses.end() && found->patch() == patch;
}

/// The edges of neighbouring smaller vertices.
struct EdgeTable::Part {
  EdgeCounts counts;
  std::vector<Edge> edges;  ///< those that bound, their uses one after the other
  std::vector<Use> uses;

  void add(const Edge& edge) {
    ++counts.edges;
    if (edge.uses.size() != 2)
      counts.is_closed = counts.is_consistent = false;
    else if (edge.uses[0].is_forward() == edge.uses[1].is_forward())
      counts.is_consistent = false;
    if (edge.is_interior()) return;
    edges.push_back(edge);
    uses.insert(uses.end(), edge.uses.begin(), edge.uses.end());
  }
};

EdgeTable::EdgeTable(std::size_t vertex_count, const Faces& faces, RunControl& control)
    : faces_(faces), bucket_(vertex_count + 1) {
  if (faces.corners.size() != 3 * faces.count()) {
    face_of_.resize(faces.corners.size());
    for_blocks(faces.count(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f)
        std::fill(face_of_.begin() + faces.face_begin[f], face_of_.begin() + faces.face_begin[f + 1],
                  static_cast<std::uint32_t>(f));
    });
  }
  // First by parts of so many smaller vertices, then each part for itself.
  const std::size_t parts = (vertex_count + kVerticesOfPart - 1) / kVerticesOfPart;
  Grouping by_part = group_by(
      faces.corners.size(), parts, [&](std::uint32_t h) { return std::min(from(h), to(h)).value / kVerticesOfPart; },
      control);
  half_edges_ = std::move(by_part.items);
  bucket_.back() = static_cast<std::uint32_t>(half_edges_.size());
  const auto found = map_blocks<Part>(parts, 1, control, [&](std::size_t part, std::size_t) {
    const std::uint32_t begin = by_part.begin[part], end = by_part.begin[part + 1];
    return sort_part(part * kVerticesOfPart, std::min(vertex_count, (part + 1) * kVerticesOfPart), begin,
                     std::span(half_edges_).subspan(begin, end - begin));
  });

  // Where each part's edges and uses go.
  std::vector<std::pair<std::size_t, std::size_t>> at(parts + 1);
  for (std::size_t i = 0; i < parts; ++i) {
    const Part& part = found[i];
    counts_.edges += part.counts.edges;
    counts_.is_closed = counts_.is_closed && part.counts.is_closed;
    counts_.is_consistent = counts_.is_consistent && part.counts.is_consistent;
    at[i + 1] = {at[i].first + part.edges.size(), at[i].second + part.uses.size()};
  }
  bounding_.edges.resize(at.back().first);
  bounding_.uses.resize(at.back().second);
  for_blocks(parts, 1, control, [&](std::size_t i, std::size_t) {
    auto [edge_at, use_at] = at[i];
    std::copy(found[i].uses.begin(), found[i].uses.end(), bounding_.uses.begin() + static_cast<std::ptrdiff_t>(use_at));
    for (Edge edge : found[i].edges) {
      edge.uses = std::span(bounding_.uses).subspan(use_at, edge.uses.size());
      use_at += edge.uses.size();
      bounding_.edges[edge_at++] = edge;
    }
  });
}

/// Puts the half-edges whose smaller vertices are in [first, last) in the order of their uses, by these vertices. They
/// are those of the table from `begin` on.
EdgeTable::Part EdgeTable::sort_part(std::size_t first, std::size_t last, std::uint32_t begin,
                                     std::span<std::uint32_t> half_edges) {
  // A counting sort by the smaller vertex, then a small sort within each bucket.
  std::vector<Use> gathered(half_edges.size());
  std::vector<std::uint16_t> low(half_edges.size());  // less `first`
  static_assert(kVerticesOfPart <= 1 << 16);
  std::vector<std::uint32_t> place(last - first + 1, 0);
  for (std::size_t i = 0; i < half_edges.size(); ++i) {
    const std::uint32_t h = half_edges[i];
    const VertexId a = from(h), b = to(h);
    gathered[i] = {std::max(a, b), faces_.patch[face_of(h)], h, a < b};
    low[i] = static_cast<std::uint16_t>(std::min(a, b).value - first);
    ++place[low[i] + 1u];
  }
  for (std::size_t v = first; v < last; ++v) {
    bucket_[v] = begin + place[v - first];
    place[v - first + 1] += place[v - first];
  }
  std::vector<Use> bucketed(half_edges.size());
  for (std::size_t i = 0; i < gathered.size(); ++i) bucketed[place[low[i]]++] = gathered[i];
  std::vector<Use>& uses = gathered;  // needed no more
  Part part;
  std::size_t start = 0;
  for (std::size_t v = first; v < last; ++v) {
    const std::size_t stop = place[v - first];
    const std::span<Use> bucket = std::span(uses).subspan(start, stop - start);
    put_in_order(std::span(bucketed).subspan(start, stop - start), bucket);
    visit_edges(VertexId(v), std::span<const Use>(bucket), [&](const Edge& edge) { part.add(edge); });
    start = stop;
  }
  std::transform(uses.begin(), uses.end(), half_edges.begin(), [](const Use& u) { return u.half_edge; });
  return part;
}

std::vector<Use> EdgeTable::find(VertexId a, VertexId b) const {
  const VertexId low = std::min(a, b), high = std::max(a, b);
  const auto high_of = [&](std::uint32_t h) { return std::max(from(h), to(h)); };
  const auto first = half_edges_.begin() + bucket_[low.value], last = half_edges_.begin() + bucket_[low.value + 1];
  auto found = std::partition_point(first, last, [&](std::uint32_t h) { return high_of(h) < high; });
  std::vector<Use> uses;
  for (; found != last && high_of(*found) == high; ++found) uses.push_back(use(*found));
  return uses;
}

}  // namespace remesh::verification
