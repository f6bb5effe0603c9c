#include "core/refinement/sampled_edges.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/base/stoppable.h"

namespace remesh {
namespace {

using Mesh = Triangulation2d;

/// The distances of samples from what they are beside grow by this factor. Samples on constrained edges, where pieces
/// are counted, are denser.
constexpr double kStep = 6, kStepInside = 8;
/// Samples are no nearer to each other than this fraction of their edge.
constexpr double kNearest = 0x1p-10;
/// The first sample beside something is no nearer to it than this fraction of the edge.
constexpr double kFirst = 0x1p-8;
/// An end of an edge gets samples if another edge there is shorter than this share of the edge.
constexpr double kShorter = 0.7;
/// The foot of a vertex gets samples if its height is less than this share of the edge.
constexpr double kLow = 0.5;
/// The vertices beside so many sides of an edge are looked at.
constexpr std::uint32_t kSides = 4;

struct Use {
  VertexId low, high;
  EdgeSide side;

  friend bool operator<(const Use& a, const Use& b) {
    return std::tie(a.low, a.high, a.side.patch, a.side.half_edge) <
           std::tie(b.low, b.high, b.side.patch, b.side.half_edge);
  }
};

double length_of(Vec2 way) { return std::sqrt(dot(way, way)); }

/// Adds places around one of them, from 0 to 1. The first ones are one step away from it.
void add_around(double place, double step, double factor, std::vector<double>& places) {
  if (place > 0 && place < 1) places.push_back(place);
  for (double away = std::max(step, kFirst); away < 1; away *= factor) {
    if (place - away > 0) places.push_back(place - away);
    if (place + away < 1) places.push_back(place + away);
  }
}

}  // namespace

SampledEdges::SampledEdges(const TriangulatedPatches& triangulated, bool has_middles, RunControl& control)
    : meshes_(triangulated.meshes) {
  StopCheck check(control);
  std::uint32_t half_edges = 0;
  begin_.reserve(meshes_.size());
  scale_.reserve(triangulated.triangle_count());
  versine_.reserve(3 * triangulated.triangle_count());
  for (std::size_t p = 0; p < meshes_.size(); ++p) {
    const PatchMesh& patch = meshes_[PatchId(p)];
    begin_.push_back(half_edges);
    half_edges += patch.mesh.half_edge_count();
    const PatchChart chart = triangulated.charts[PatchId(p)];
    for (std::uint32_t h = 0; h < patch.mesh.half_edge_count(); h += 3) {
      check();
      const Vec2 p[3] = {patch.uv[patch.mesh.from(h)], patch.uv[patch.mesh.from(h + 1)],
                         patch.uv[patch.mesh.from(h + 2)]};
      scale_.push_back(chart.scale(p[0]));
      add_versines(p);
    }
  }
  edge_of_.resize(half_edges);
  sides_.reserve(half_edges);
  half_edges_.reserve(half_edges);
  number_constrained(control);
  number_others(control);
  place_samples(has_middles, control);
}

/// Adds the versines of a triangle's corners.
void SampledEdges::add_versines(const Vec2 (&p)[3]) {
  Vec2 direction[3];
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2 side = p[(k + 1) % 3] - p[k];
    const double length = length_of(side);
    direction[k] = length > 0 ? (1 / length) * side : Vec2{};
  }
  for (std::size_t k = 0; k < 3; ++k) {
    // The sum of one side's direction and the reversed one of the side before: exact also where the angle is tiny.
    const Vec2 apart = direction[k] + direction[(k + 2) % 3];
    versine_.push_back(static_cast<float>(dot(apart, apart) / 2));
  }
}

void SampledEdges::add_edge(EdgeSide side, bool is_constrained) {
  const PatchMesh& patch = meshes_[side.patch];
  const Vec2 way = patch.uv[patch.mesh.to(side.half_edge)] - patch.uv[patch.mesh.from(side.half_edge)];
  const auto first = static_cast<std::uint32_t>(sides_.size());
  edges_.push_back({first, 0, 0, 0, length_of(way) * scale(side), is_constrained});
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
  // The sides are put in order by their lower vertices, and then those of each lower vertex by the higher ones.
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
  std::vector<Use> uses(count);
  for_all_sides([&](const Use& use) { uses[begin[use.low.value]++] = use; });
  for (std::size_t first = 0, end = 0; first < uses.size(); first = end) {
    while (end < uses.size() && uses[end].low == uses[first].low) ++end;
    const auto at = [&](std::size_t i) { return uses.begin() + static_cast<std::ptrdiff_t>(i); };
    sort_stoppable(at(first), at(end), control);
  }
  for (std::size_t i = 0; i < uses.size(); ++i) {
    check();
    const EdgeSide side = uses[i].side;
    if (i == 0 || uses[i - 1].low != uses[i].low || uses[i - 1].high != uses[i].high) add_edge(side, true);
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

void SampledEdges::place_samples(bool has_middles, RunControl& control) {
  StopCheck check(control);
  std::vector<double> shortest;
  for (const SampledEdge& e : edges_) {
    check();
    const EdgeSide side = sides_[e.first_side];
    const PatchMesh& patch = meshes_[side.patch];
    for (const std::uint32_t v : {patch.mesh.from(side.half_edge), patch.mesh.to(side.half_edge)}) {
      const std::size_t vertex = patch.vertices[v].value;
      if (vertex >= shortest.size()) shortest.resize(std::max(vertex + 1, 2 * shortest.size()), HUGE_VAL);
      shortest[vertex] = std::min(shortest[vertex], e.length);
    }
  }
  std::vector<double> places;
  for (std::uint32_t i = 0; i < size(); ++i) {
    check();
    places.clear();
    add_beside(i, shortest, places);
    if (has_middles || !places.empty()) places.push_back(0.5);
    places.insert(places.end(), {0, 1});
    std::sort(places.begin(), places.end());
    SampledEdge& e = edges_[i];
    e.first_sample = static_cast<std::uint32_t>(place_.size());
    for (const double place : places) {
      const bool is_near = place_.size() > e.first_sample && place - place_.back() < kNearest;
      if (!is_near)
        place_.push_back(place);
      else if (place == 1)
        place_.back() = 1;
    }
    e.sample_count = static_cast<std::uint32_t>(place_.size()) - e.first_sample;
  }
}

}  // namespace remesh
