#include "core/refinement/prediction/sampled_edges.h"

#include <cmath>
#include <tuple>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"

namespace remesh {
namespace {

using Mesh = Triangulation2d;

/// The distance of a sample from the feature beside it grows by this factor from sample to sample. Samples on
/// constrained edges, where pieces are counted, are denser.
constexpr double kStep = 12, kStepInside = 16;
/// The min distance of two samples, as a fraction of their edge.
constexpr double kNearest = 0x1p-9;
/// The min distance of the first sample from the feature beside it, as a fraction of the edge.
constexpr double kFirst = 0x1p-8;
/// An end of an edge gets samples if another edge there is shorter than this share of the edge.
constexpr double kShorter = 0.7;
/// The foot of a vertex gets samples if its height is less than this share of the edge.
constexpr double kLow = 0.5;
/// The max number of sides of an edge whose opposite vertices are tested.
constexpr std::uint32_t kSides = 4;

struct Use {
  VertexId low, high;
  EdgeSide side;

  friend bool operator<(const Use& a, const Use& b) {
    return std::tie(a.low, a.high, a.side.patch, a.side.half_edge) <
           std::tie(b.low, b.high, b.side.patch, b.side.half_edge);
  }
};

double length_of_way(Vec2 way) { return std::sqrt(dot(way, way)); }

/// Adds places around `place`, from 0 to 1. The first ones are about one step away from it. The distances are the same
/// for all steps, so that places coincide where several features ask for them.
void add_around(double place, double step, double factor, std::vector<double>& places) {
  if (place > 0 && place < 1) places.push_back(place);
  double away = kFirst;
  while (away * away * factor <= step * step) away *= factor;
  for (; away < 1; away *= factor) {
    if (place - away > 0) places.push_back(place - away);
    if (place + away < 1) places.push_back(place + away);
  }
}

/// Errors: kOutOfMemory - see MemoryBound.
template <class T>
void reserve_asking(std::vector<T>& items, std::size_t count, const RunControl& control) {
  control.memory().ask_for<T>(count);
  items.reserve(count);
}

}  // namespace

SampledEdges::SampledEdges(const TriangulatedPatches& triangulated, bool has_middles, RunControl& control)
    : meshes_(triangulated.meshes) {
  constexpr std::size_t kPatches = 64;
  std::uint32_t half_edges = 0;
  begin_.reserve(meshes_.size());
  for (const PatchMesh& patch : meshes_) {
    begin_.push_back(half_edges);
    half_edges += patch.mesh.half_edge_count();
  }
  control.memory().ask_for<Steps>(meshes_.size());
  steps_.resize(meshes_.size());
  control.memory().ask_for<double>(half_edges / 3);
  scale_.resize(half_edges / 3);
  control.memory().ask_for<float>(half_edges);
  versine_.resize(half_edges);
  for_blocks(meshes_.size(), kPatches, control, [&](std::size_t begin, std::size_t end) {
    for (PatchId p(static_cast<std::uint32_t>(begin)); p.value < end; ++p.value) measure(triangulated, p, control);
  });
  reserve_asking(edge_of_, half_edges, control);
  edge_of_.resize(half_edges);
  reserve_asking(sides_, half_edges, control);
  reserve_asking(half_edges_, half_edges, control);
  number_constrained(control);
  number_others(control);
  place_samples(has_middles, control);
}

/// Measures the triangles of a patch.
void SampledEdges::measure(const TriangulatedPatches& triangulated, PatchId p, RunControl& control) {
  StopCheck check(control);
  const PatchMesh& patch = meshes_[p];
  const PatchChart chart = triangulated.charts[p];
  double largest = 0;
  for (const Vec2 place : patch.uv) {
    check();
    const Vec3 v = chart.to_space(place);
    largest = std::max({largest, std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
  }
  steps_[p] = {0x1p-52 * largest, chart.grid()};
  for (std::uint32_t h = 0; h < patch.mesh.half_edge_count(); h += 3) {
    check();
    const Vec2 corners[3] = {patch.uv[patch.mesh.from(h)], patch.uv[patch.mesh.from(h + 1)],
                             patch.uv[patch.mesh.from(h + 2)]};
    scale_[triangle_of({p, h})] = chart.scale(corners[0]);
    add_versines(begin_[p] + h, corners);
  }
}

/// Adds the versines of a triangle's corners.
/// Input: `first` is its first half-edge among those of all patches.
void SampledEdges::add_versines(std::uint32_t first, const Vec2 (&p)[3]) {
  Vec2 direction[3];
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2 side = p[(k + 1) % 3] - p[k];
    const double length = length_of_way(side);
    direction[k] = length > 0 ? (1 / length) * side : Vec2{};
  }
  for (std::uint32_t k = 0; k < 3; ++k) {
    // The sum of one side's direction and the reversed direction of the side before it. It is exact even if the angle
    // is tiny.
    const Vec2 apart = direction[k] + direction[(k + 2) % 3];
    versine_[first + k] = static_cast<float>(dot(apart, apart) / 2);
  }
}

void SampledEdges::add_edge(EdgeSide side, bool is_constrained) {
  const PatchMesh& patch = meshes_[side.patch];
  const Vec2 way = patch.uv[patch.mesh.to(side.half_edge)] - patch.uv[patch.mesh.from(side.half_edge)];
  const auto first = static_cast<std::uint32_t>(sides_.size());
  edges_.push_back({first, 0, 0, 0, length_of_way(way) * scale(side), is_constrained});
}

/// Adds a side to the last edge.
void SampledEdges::add_side(EdgeSide side, bool is_forward) {
  ++edges_.back().side_count;
  edge_of_[begin_[side.patch] + side.half_edge] = 2 * (size() - 1) + (is_forward ? 1 : 0);
  sides_.push_back(side);
  half_edges_.push_back(begin_[side.patch] + side.half_edge);
}

void SampledEdges::number_constrained(RunControl& control) {
  StopCheck check(control);
  // The sides are sorted by their lower vertices, and then those of each lower vertex by their higher ones.
  std::vector<std::uint32_t> begin;
  std::size_t count = 0;
  const auto for_all_sides = [&](const auto& body) {
    for (std::size_t p = 0; p < meshes_.size(); ++p) {
      const PatchMesh& patch = meshes_[PatchId(p)];
      for (std::uint32_t h = 0; h < patch.mesh.half_edge_count(); ++h) {
        check();
        if (!patch.mesh.is_constrained(h)) continue;
        const auto [low, high] = std::minmax(patch.vertices[patch.mesh.from(h)], patch.vertices[patch.mesh.to(h)]);
        body(Use{low, high, {PatchId(p), h}});
      }
    }
  };
  for_all_sides([&](const Use& use) {
    if (use.low.value + 2 > begin.size()) begin.resize(std::max<std::size_t>(use.low.value + 2, 2 * begin.size()), 0);
    ++begin[use.low.value + 1];
    ++count;
  });
  for (std::size_t v = 1; v < begin.size(); ++v) begin[v] += begin[v - 1];
  control.memory().ask_for<Use>(count);
  std::vector<Use> uses(count);
  for_all_sides([&](const Use& use) { uses[begin[use.low.value]++] = use; });
  for (std::size_t first = 0, end = 0; first < uses.size(); first = end) {
    while (end < uses.size() && uses[end].low == uses[first].low) ++end;
    const auto at = [&](std::size_t i) { return uses.begin() + static_cast<std::ptrdiff_t>(i); };
    sort_stoppable(at(first), at(end), control);
  }
  const auto is_other_edge = [&](std::size_t i) {
    return i == 0 || uses[i - 1].low != uses[i].low || uses[i - 1].high != uses[i].high;
  };
  std::size_t edges = 0;
  for (std::size_t i = 0; i < uses.size(); ++i) edges += is_other_edge(i) ? 1 : 0;
  // The remaining sides are those of edges between two triangles of a patch, or few more.
  reserve_asking(edges_, edges + (edge_of_.size() - uses.size() + 1) / 2, control);
  for (std::size_t i = 0; i < uses.size(); ++i) {
    check();
    const EdgeSide side = uses[i].side;
    if (is_other_edge(i)) add_edge(side, true);
    const PatchMesh& patch = meshes_[side.patch];
    add_side(side, patch.vertices[patch.mesh.from(side.half_edge)] == uses[i].low);
  }
}

void SampledEdges::number_others(RunControl& control) {
  StopCheck check(control);
  for (std::size_t p = 0; p < meshes_.size(); ++p) {
    const Mesh& mesh = meshes_[PatchId(p)].mesh;
    for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h) {
      check();
      const std::uint32_t twin = mesh.twin(h);
      if (mesh.is_constrained(h) || twin < h) continue;
      add_edge({PatchId(p), h}, false);
      add_side({PatchId(p), h}, true);
      if (twin != Mesh::kNoHalfEdge) add_side({PatchId(p), twin}, false);
    }
  }
}

/// Adds the places beside the ends of an edge and beside the feet of vertices.
/// Input: `shortest` has the length of the shortest edge at each vertex.
void SampledEdges::add_beside(std::uint32_t index, const std::vector<double>& shortest,
                              std::vector<double>& places) const {
  const SampledEdge& e = edges_[index];
  const double factor = e.is_constrained ? kStep : kStepInside;
  bool is_first = true;
  for (const EdgeSide side : sides(e).first(std::min(e.side_count, kSides))) {
    const PatchMesh& patch = meshes_[side.patch];
    const auto [from, step] = way(side);
    if (std::exchange(is_first, false)) {
      const bool forward = is_forward(side);
      for (const bool is_start : {true, false}) {
        const std::uint32_t h = side.half_edge;
        const std::uint32_t v = is_start == forward ? patch.mesh.from(h) : patch.mesh.to(h);
        const double there = shortest[patch.vertices[v].value];
        if (there < kShorter * e.length) add_around(is_start ? 0 : 1, there / e.length, factor, places);
      }
    }
    const Vec2 apex = patch.uv[patch.mesh.apex(side.half_edge)] - from;
    const double squared = dot(step, step);
    if (!(squared > 0)) continue;
    const double height = std::fabs(cross(step, apex)) / squared;
    if (height < kLow) add_around(std::clamp(dot(apex, step) / squared, 0.0, 1.0), height, factor, places);
  }
}

/// Returns the length of the shortest edge at each vertex.
std::vector<double> SampledEdges::shortest_at_vertices(RunControl& control) const {
  StopCheck check(control);
  std::vector<double> shortest;
  for (const SampledEdge& e : edges_) {
    check();
    const EdgeSide side = sides_[e.first_side];
    const PatchMesh& patch = meshes_[side.patch];
    for (const std::uint32_t v : {patch.mesh.from(side.half_edge), patch.mesh.to(side.half_edge)}) {
      const std::size_t vertex = patch.vertices[v].value;
      if (vertex >= shortest.size()) {
        const std::size_t count = std::max(vertex + 1, 2 * shortest.size());
        control.memory().ask_for<double>(count);
        shortest.resize(count, HUGE_VAL);
      }
      shortest[vertex] = std::min(shortest[vertex], e.length);
    }
  }
  return shortest;
}

void SampledEdges::place_samples(bool has_middles, RunControl& control) {
  constexpr std::size_t kEdges = 1024;
  const std::vector<double> shortest = shortest_at_vertices(control);
  const auto blocks =
      map_blocks<std::vector<double>>(edges_.size(), kEdges, control, [&](std::size_t i, std::size_t end) {
        std::vector<double> all, places;
        all.reserve(4 * (end - i));
        for (; i < end; ++i) {
          places.clear();
          add_beside(static_cast<std::uint32_t>(i), shortest, places);
          const bool has_middle = has_middles || !places.empty();
          if (has_middle) places.push_back(0.5);
          std::sort(places.begin(), places.end());
          const std::size_t first = all.size();
          all.push_back(0);
          for (const double place : places)
            if (place - all.back() >= kNearest && 1 - place >= kNearest) all.push_back(place);
          all.push_back(1);
          edges_[i].sample_count = static_cast<std::uint32_t>(all.size() - first);
        }
        return all;
      });
  place_ = concatenate<double>(blocks, control);
  std::uint32_t first = 0;
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    edges_[i].first_sample = first;
    first += edges_[i].sample_count;
  }
}

}  // namespace remesh
