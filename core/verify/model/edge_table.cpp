#include "core/verify/model/edge_table.h"

#include <atomic>
#include <numeric>

#include "core/base/blocks.h"
#include "core/base/grouping.h"
#include "core/base/sort_few.h"

namespace remesh::verification {
namespace {

constexpr std::size_t kVerticesOfPart = 1024;

/// A use as one number. The keys of one smaller vertex are sorted like its uses, except for their patches.
std::uint64_t key_of(VertexId high, std::uint32_t half_edge) { return std::uint64_t{high.value} << 32 | half_edge; }
std::uint32_t half_edge_of(std::uint64_t key) { return static_cast<std::uint32_t>(key); }
VertexId high_of(std::uint64_t key) { return VertexId(static_cast<std::uint32_t>(key >> 32)); }

/// True if both lists contain the keys of the same edges, each once.
bool have_same_edges(std::span<const std::uint64_t> forward, std::span<const std::uint64_t> backward) {
  if (forward.size() != backward.size()) return false;
  for (std::size_t i = 0; i < forward.size(); ++i) {
    const bool is_repeated = i > 0 && high_of(forward[i]) == high_of(forward[i - 1]);
    if (is_repeated || high_of(forward[i]) != high_of(backward[i])) return false;
  }
  return true;
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

/// The edges of a range of smaller vertices.
struct EdgeTable::Part {
  EdgeCounts counts;
  std::vector<Edge> edges;  ///< the bounding edges; their uses follow each other in `uses`
  std::vector<Use> uses;

  void add(const Edge& edge, const Faces& faces) {
    ++counts.edges;
    if (edge.uses.size() != 2)
      counts.is_closed = counts.is_consistent = false;
    else if (edge.uses[0].is_forward() == edge.uses[1].is_forward())
      counts.is_consistent = false;
    const auto is_of_kept = [&](const Use& use) { return faces.is_kept[use.patch().value] != 0; };
    if (edge.is_interior()) return;
    if (!faces.is_kept.empty() && std::all_of(edge.uses.begin(), edge.uses.end(), is_of_kept)) return;
    edges.push_back(edge);
    uses.insert(uses.end(), edge.uses.begin(), edge.uses.end());
  }
};

EdgeTable::EdgeTable(std::size_t vertex_count, const Faces& faces, std::span<const std::uint32_t> order,
                     RunControl& control)
    : faces_(faces), control_(control), bucket_(vertex_count + 1), order_(order) {
  if (faces.corners.size() != 3 * faces.count()) {
    face_of_.resize(faces.corners.size());
    for_blocks(faces.count(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f)
        std::fill(face_of_.begin() + faces.face_begin[f], face_of_.begin() + faces.face_begin[f + 1],
                  static_cast<std::uint32_t>(f));
    });
  }
  bucket_.back() = static_cast<std::uint32_t>(faces.corners.size());
  std::vector<Part> parts = read_order(control);
  if (parts.empty()) parts = sort(control);
  add_parts(parts, control);
}

/// Reads the edges from the given order.
/// Output: nothing if the order is not valid.
std::vector<EdgeTable::Part> EdgeTable::read_order(RunControl& control) {
  if (order_.empty() || order_.size() != faces_.corners.size()) return {};
  auto found =
      map_blocks<std::optional<Part>>(order_.size(), kItemsPerBlock, control,
                                      [&](std::size_t begin, std::size_t end) { return read_part(begin, end); });
  std::vector<Part> parts;
  parts.reserve(found.size());
  for (std::optional<Part>& part : found) {
    if (!part) return {};
    parts.push_back(*std::move(part));
  }
  return parts;
}

/// Reads the edges that begin in [begin, end) of the order, and sets the buckets that begin there.
/// Output: nothing if the half-edges do not ascend there. If they ascend everywhere, they are all different, and so
///         none is missing.
std::optional<EdgeTable::Part> EdgeTable::read_part(std::size_t begin, std::size_t end) {
  using Ends = std::pair<VertexId, VertexId>;
  const auto ends = [&](std::uint32_t h) {
    const VertexId a = from(h), b = to(h);
    return a < b ? Ends{a, b} : Ends{b, a};
  };
  Part part;
  std::vector<Use> uses;
  const auto add_edge = [&](std::size_t first, std::size_t last, const Ends& edge) {
    const std::uint32_t g = order_[first], h = order_[first + 1 < last ? first + 1 : first];
    if (last - first == 2 && from(g) == to(h) && edge.first != edge.second && is_no_bound(g, h)) {
      ++part.counts.edges;  // the table never needs the uses of most edges
      return;
    }
    uses.clear();
    for (std::size_t i = first; i < last; ++i) uses.push_back(use(order_[i]));
    sort_stoppable(uses.begin(), uses.end(), control_);
    part.add({edge.first, edge.second, uses}, faces_);
  };
  std::size_t next_bucket = 0, first = end;  // beginning of the edge that is being read, if it is in this range
  Ends last_ends;
  std::uint32_t last_half_edge = 0;
  const auto is_half_edge = [&](std::uint32_t h) { return h < order_.size(); };
  if (begin > 0) {
    last_half_edge = order_[begin - 1];
    if (!is_half_edge(last_half_edge)) return std::nullopt;
    last_ends = ends(last_half_edge);
    next_bucket = last_ends.first.value + std::size_t{1};
  }
  for (std::size_t i = begin; i < end; ++i) {
    const std::uint32_t h = order_[i];
    if (!is_half_edge(h)) return std::nullopt;
    const Ends here = ends(h);
    if (i > 0 && here == last_ends) {
      if (h <= last_half_edge) return std::nullopt;
    } else {
      if (i > 0 && here < last_ends) return std::nullopt;
      if (first < i) add_edge(first, i, last_ends);
      first = i;
      // Two threads set the same bucket only if the order is not valid.
      for (; next_bucket <= here.first.value; ++next_bucket)
        std::atomic_ref(bucket_[next_bucket]).store(static_cast<std::uint32_t>(i), std::memory_order_relaxed);
    }
    last_ends = here;
    last_half_edge = h;
  }
  if (first < end) {
    std::size_t last = end;
    StopCheck check(control_);
    while (last < order_.size() && is_half_edge(order_[last]) && ends(order_[last]) == last_ends) {
      check();
      ++last;
    }
    add_edge(first, last, last_ends);
  }
  if (end == order_.size())
    for (; next_bucket < vertex_count(); ++next_bucket)
      std::atomic_ref(bucket_[next_bucket]).store(static_cast<std::uint32_t>(end), std::memory_order_relaxed);
  return part;
}

/// Sorts the half-edges and reads the edges from them.
std::vector<EdgeTable::Part> EdgeTable::sort(RunControl& control) {
  // The half-edges are first grouped into parts of `kVerticesOfPart` smaller vertices, and then each part is sorted
  // by itself.
  const std::size_t vertices = vertex_count(), parts = (vertices + kVerticesOfPart - 1) / kVerticesOfPart;
  Grouping by_part = group_by(
      faces_.corners.size(), parts, [&](std::uint32_t h) { return std::min(from(h), to(h)).value / kVerticesOfPart; },
      control);
  half_edges_ = std::move(by_part.items);
  order_ = half_edges_;
  return map_blocks<Part>(parts, 1, control, [&](std::size_t part, std::size_t) {
    const std::uint32_t begin = by_part.begin[part], end = by_part.begin[part + 1];
    return sort_part(part * kVerticesOfPart, std::min(vertices, (part + 1) * kVerticesOfPart), begin,
                     std::span(half_edges_).subspan(begin, end - begin));
  });
}

void EdgeTable::add_parts(const std::vector<Part>& parts, RunControl& control) {
  // Here begin the edges and uses of each part.
  std::vector<std::pair<std::size_t, std::size_t>> at(parts.size() + 1);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Part& part = parts[i];
    counts_.edges += part.counts.edges;
    counts_.is_closed = counts_.is_closed && part.counts.is_closed;
    counts_.is_consistent = counts_.is_consistent && part.counts.is_consistent;
    at[i + 1] = {at[i].first + part.edges.size(), at[i].second + part.uses.size()};
  }
  bounding_.edges.resize(at.back().first);
  bounding_.uses.resize(at.back().second);
  for_blocks(parts.size(), 1, control, [&](std::size_t i, std::size_t) {
    auto [edge_at, use_at] = at[i];
    std::copy(parts[i].uses.begin(), parts[i].uses.end(), bounding_.uses.begin() + static_cast<std::ptrdiff_t>(use_at));
    for (Edge edge : parts[i].edges) {
      edge.uses = std::span(bounding_.uses).subspan(use_at, edge.uses.size());
      use_at += edge.uses.size();
      bounding_.edges[edge_at++] = edge;
    }
  });
}

/// Sorts the half-edges whose smaller vertices are in [first, last) by these vertices, and within each in the order
/// of their uses. In the table they begin at `begin`.
EdgeTable::Part EdgeTable::sort_part(std::size_t first, std::size_t last, std::uint32_t begin,
                                     std::span<std::uint32_t> half_edges) {
  // This is a counting sort by the smaller vertex, followed by a small sort within each bucket.
  using Keys = std::vector<std::uint64_t, DefaultInit<std::uint64_t>>;
  Keys gathered(half_edges.size()), bucketed(half_edges.size());
  // The half-edges are also separated by direction. For a sound surface, the same edges occur forward and backward.
  std::vector<std::uint16_t, DefaultInit<std::uint16_t>> bucket_of(half_edges.size());
  static_assert(2 * kVerticesOfPart <= 1 << 16);
  std::vector<std::uint32_t> place(2 * (last - first) + 1, 0);
  StopCheck check(control_);
  for (std::size_t i = 0; i < half_edges.size(); ++i) {
    check();
    const std::uint32_t h = half_edges[i];
    const VertexId a = from(h), b = to(h);
    gathered[i] = key_of(std::max(a, b), h);
    bucket_of[i] = static_cast<std::uint16_t>(2 * (std::min(a, b).value - first) + (a < b ? 0u : 1u));
    ++place[bucket_of[i] + 1u];
  }
  std::partial_sum(place.begin(), place.end(), place.begin());
  for (std::size_t v = first; v < last; ++v) bucket_[v] = begin + place[2 * (v - first)];
  for (std::size_t i = 0; i < gathered.size(); ++i) {
    check();
    bucketed[place[bucket_of[i]]++] = gathered[i];
  }
  Part part;
  std::vector<Use> uses;
  const auto add_edge = [&](std::size_t v, VertexId high, std::span<std::uint32_t> around) {
    uses.clear();
    for (const std::uint32_t h : around) uses.push_back(use(h));
    sort_stoppable(uses.begin(), uses.end(), control_);
    std::transform(uses.begin(), uses.end(), around.begin(), [](const Use& u) { return u.half_edge; });
    part.add({VertexId(v), high, uses}, faces_);
  };
  const std::span<std::uint64_t> all(bucketed), sorted(gathered);  // the gathered keys are no longer needed
  std::size_t start = 0;
  for (std::size_t v = first; v < last; ++v) {
    const std::size_t middle = place[2 * (v - first)], stop = place[2 * (v - first) + 1];
    const auto forward = sorted.subspan(start, middle - start), backward = sorted.subspan(middle, stop - middle);
    sort_few(all.subspan(start, forward.size()), forward, control_);
    sort_few(all.subspan(middle, backward.size()), backward, control_);
    if (have_same_edges(forward, backward)) {
      for (std::size_t i = 0; i < forward.size(); ++i) {
        check();
        const auto around = half_edges.subspan(start + 2 * i, 2);
        const std::uint32_t g = half_edge_of(forward[i]), h = half_edge_of(backward[i]);
        const auto [first_use, second_use] = std::minmax({std::pair(patch_of(g), g), std::pair(patch_of(h), h)});
        around[0] = first_use.second;
        around[1] = second_use.second;
        if (is_no_bound(g, h))
          ++part.counts.edges;  // the table never needs the uses of most edges
        else
          add_edge(v, high_of(forward[i]), around);
      }
    } else {
      const auto both = sorted.subspan(start, stop - start);
      sort_stoppable(both.begin(), both.end(), control_);
      for (std::size_t i = 0, j; i < both.size(); i = j) {
        check();
        for (j = i + 1; j < both.size() && high_of(both[j]) == high_of(both[i]);) ++j;
        const auto around = half_edges.subspan(start + i, j - i);
        std::transform(both.begin() + static_cast<std::ptrdiff_t>(i), both.begin() + static_cast<std::ptrdiff_t>(j),
                       around.begin(), half_edge_of);
        add_edge(v, high_of(both[i]), around);
      }
    }
    start = stop;
  }
  return part;
}

std::span<const std::uint32_t> EdgeTable::half_edges_of(VertexId a, VertexId b) const {
  const VertexId low = std::min(a, b), high = std::max(a, b);
  const auto high_of = [&](std::uint32_t h) { return std::max(from(h), to(h)); };
  const auto around = order_.subspan(bucket_[low.value], bucket_[low.value + 1] - bucket_[low.value]);
  const auto first =
      std::partition_point(around.begin(), around.end(), [&](std::uint32_t h) { return high_of(h) < high; });
  return {first, std::partition_point(first, around.end(), [&](std::uint32_t h) { return high_of(h) == high; })};
}

std::vector<Use> EdgeTable::find(VertexId a, VertexId b) const {
  std::vector<Use> uses;
  StopCheck check(control_);
  for (const std::uint32_t h : half_edges_of(a, b)) {
    check();
    uses.push_back(use(h));
  }
  if (is_order_given()) sort_stoppable(uses.begin(), uses.end(), control_);
  return uses;
}

}  // namespace remesh::verification
