#include "core/patches/chains/curve_cuts.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"
#include "core/geometry/triangles/distances.h"
#include "core/patches/chains/boundary_chains.h"
#include "core/patches/chains/chain_gaps.h"

namespace remesh {
namespace {

bool has_formula(SurfaceKind kind) {
  return kind == SurfaceKind::kCylinder || kind == SurfaceKind::kCone || kind == SurfaceKind::kSphere ||
         kind == SurfaceKind::kTorus;
}

bool is_curved(const PatchSurface& surface) { return surface.shape != nullptr; }

/// Cuts all chains, and then finds chains that would become the same edge.
class CurveCutter {
 public:
  CurveCutter(const PatchBoundaries& boundaries, const IdVector<PatchId, PatchSurface>& surfaces,
              const CurveRules& rules, RunControl& control)
      : in_(boundaries), surfaces_(surfaces), rules_(rules), check_(control), control_(control) {}

  CurveCuts run() {
    result_.essential = in_.essential;
    IdVector<PatchId, std::uint8_t> curved(surfaces_.size(), 0);
    for (PatchId p(0); p.value < surfaces_.size(); ++p.value) curved[p] = is_curved(surfaces_[p]);
    if (std::find(curved.begin(), curved.end(), 1) == curved.end()) return std::move(result_);
    chains_ = boundary_chains(in_.surface, in_.adjacency, in_.patches, in_.loops, in_.essential, in_.pinched, curved,
                              control_);
    cut_all();
    result_.sideways.assign(surfaces_.size(), 0);
    for (const ChainCut& cut : cuts_) {
      apply(cut);
      measure_way_along_surfaces(cut);
    }
    part_doubled_edges();
    std::sort(result_.starts.begin(), result_.starts.end(),
              [](const CurveCuts::Start& a, const CurveCuts::Start& b) { return a.half_edge < b.half_edge; });
    return std::move(result_);
  }

 private:
  using Start = CurveCuts::Start;

  /// The straight piece between two nodes of a cut that stay, across nodes that were dropped.
  struct Piece {
    VertexId low, high;
    std::uint32_t edge;  ///< the first half-edge of the input's edge at `low`
    const ChainCut* cut;
    std::uint32_t first, last;  ///< nodes of the cut

    std::pair<VertexId, VertexId> key() const { return {low, high}; }
  };

  std::uint32_t first_of_edge(std::uint32_t h) const {
    const std::uint32_t twin = in_.adjacency.twin(h);
    return twin != kNone ? std::min(h, twin) : in_.adjacency.half_edges(in_.adjacency.edge_of(h))[0];
  }

  /// Returns the patches beside a chain, in an order that depends on geometry alone. If the surface of a patch has no
  /// formula, no patch counts as curved.
  ChainSides sides_of(std::span<const ChainNode> chain) const {
    ChainSides sides;
    std::vector<PatchId> beside;
    for (const std::uint32_t h : half_edges_along(in_.adjacency, chain.front().after))
      beside.push_back(in_.patches.of_face[in_.adjacency.face_of(h)]);
    sort_unique(beside);
    const auto plane_key = [&](PatchId p) { return std::tie(surfaces_[p].plane.normal, surfaces_[p].plane.origin); };
    std::sort(beside.begin(), beside.end(), [&](PatchId p, PatchId q) { return plane_key(p) < plane_key(q); });
    for (const PatchId p : beside) {
      if (is_curved(surfaces_[p])) {
        if (!has_formula(surfaces_[p].shape->kind)) return {};
        sides.curved.push_back(surfaces_[p]);
        continue;
      }
      const Plane& plane = surfaces_[p].plane;
      sides.planar.push_back(p);
      sides.planes.push_back({in_.surface.centre + in_.surface.unit * plane.origin, plane.normal});
    }
    std::sort(sides.curved.begin(), sides.curved.end(), [](const PatchSurface& a, const PatchSurface& b) {
      const auto key = [](const PatchSurface& s) {
        return std::tie(s.shape->kind, s.shape->origin, s.shape->axis, s.shape->radius, s.shape->minor_radius,
                        s.shape->half_angle);
      };
      return key(a) < key(b);
    });
    return sides;
  }

  void cut_all() {
    IdVector<PatchId, std::uint8_t> is_searched(surfaces_.size(), 0);
    for (std::size_t c = 0; c < chains_.size(); ++c) {
      check_();
      for (const std::uint32_t h : half_edges_along(in_.adjacency, chains_[c].front().after)) {
        const PatchId p = in_.patches.of_face[in_.adjacency.face_of(h)];
        if (!is_curved(surfaces_[p])) is_searched[p] = 1;
      }
    }
    const ChainGaps gaps(in_.surface, in_.adjacency, in_.loops, in_.essential, chains_, is_searched, control_);
    const ChainCutting cutting{in_.surface, in_.forced, gaps, rules_, control_};
    struct Block {
      std::vector<ChainCut> cuts;
      std::uint64_t cut_chains = 0, capped = 0;
    };
    constexpr std::size_t kChainsPerBlock = 64;
    auto blocks = map_blocks<Block>(chains_.size(), kChainsPerBlock, control_, [&](std::size_t c, std::size_t end) {
      Block block;
      for (; c < end; ++c) {
        control_.check();
        const ChainSides sides = sides_of(chains_[c]);
        if (sides.curved.empty()) continue;
        const std::size_t before = block.cuts.size();
        block.capped += cut_chain(static_cast<std::uint32_t>(c), chains_[c], sides, cutting, block.cuts) ? 1 : 0;
        block.cut_chains += block.cuts.size() > before ? 1 : 0;
      }
      return block;
    });
    for (Block& block : blocks) {
      result_.cut_chains += block.cut_chains;
      result_.capped += block.capped;
      std::move(block.cuts.begin(), block.cuts.end(), std::back_inserter(cuts_));
    }
  }

  void apply(const ChainCut& cut) {
    std::size_t next = 0;
    for (std::uint32_t i = 1; i + 1 < cut.nodes.size(); ++i) {
      check_();
      if (next < cut.kept.size() && cut.kept[next] == i)
        ++next;
      else
        result_.essential.stays[cut.nodes[i].vertex] = 0;
    }
    if (!cut.points.empty()) add_points(cut, cut.points);
  }

  /// For each curved patch beside a cut, finds how far the cut has moved the patch's boundary along the surface.
  void measure_way_along_surfaces(const ChainCut& cut) {
    std::vector<Vec3> before, now;
    for (const ChainNode& node : cut.nodes) before.push_back(in_.surface.positions[node.vertex]);
    now.push_back(before.front());
    for (const std::uint32_t i : cut.kept) now.push_back(before[i]);
    now.insert(now.end(), cut.points.begin(), cut.points.end());
    now.push_back(before.back());
    for (const std::uint32_t h : half_edges_along(in_.adjacency, cut.nodes.front().after)) {
      const PatchId p = in_.patches.of_face[in_.adjacency.face_of(h)];
      if (!is_curved(surfaces_[p])) continue;
      const AnalyticSurface& shape = *surfaces_[p].shape;
      if (is_around_cylinder(before, shape) && is_around_cylinder(now, shape)) continue;
      result_.sideways[p] =
          std::max({result_.sideways[p], way_along(before, now, shape), way_along(now, before, shape)});
    }
  }

  /// Returns whether a polyline runs around the axis of a cylinder. Between two such lines in one plane, all ways are
  /// normal to the cylinder, while the shortest ways to coarse pieces are not.
  bool is_around_cylinder(std::span<const Vec3> line, const AnalyticSurface& shape) {
    if (shape.kind != SurfaceKind::kCylinder) return false;
    return std::all_of(line.begin(), line.end(), [&](const Vec3& p) {
      check_();
      return std::fabs(dot(p - line.front(), shape.axis)) <= 2 * rules_.fit_tolerance;
    });
  }

  /// Returns the largest way along a surface from points of one polyline to another one that runs beside it.
  double way_along(std::span<const Vec3> points, std::span<const Vec3> line, const AnalyticSurface& shape) {
    double longest = 0;
    std::size_t i = 0;
    for (const Vec3& p : points) {
      check_();
      const auto way_to = [&](std::size_t k) { return nearest_on_segment(p, line[k], line[k + 1]) - p; };
      Vec3 way = way_to(i);
      for (; i + 2 < line.size(); ++i) {
        const Vec3 next = way_to(i + 1);
        if (norm_squared(next) > norm_squared(way)) break;
        way = next;
      }
      const double across = dot(way, shape.normal(p));
      longest = std::max(longest, std::sqrt(std::max(0.0, norm_squared(way) - across * across)));
    }
    return longest;
  }

  /// Adds new vertices between the ends of a cut, for the patches on all of its sides.
  void add_points(const ChainCut& cut, std::span<const Vec3> points) {
    const auto list = [&](bool is_forward) {
      const auto begin = static_cast<std::uint32_t>(result_.lists.size());
      for (std::size_t i = 0; i < points.size(); ++i) {
        const std::size_t place = is_forward ? i : points.size() - 1 - i;
        result_.lists.push_back(VertexId(in_.surface.vertex_count() + result_.positions.size() + place));
      }
      const ChainNode& node = is_forward ? cut.nodes.front() : cut.nodes.back();
      for (const std::uint32_t h : half_edges_along(in_.adjacency, is_forward ? node.after : node.before))
        if (in_.adjacency.from(h) == node.vertex)
          result_.starts.push_back({h, begin, static_cast<std::uint32_t>(result_.lists.size())});
    };
    list(true);
    list(false);
    result_.positions.insert(result_.positions.end(), points.begin(), points.end());
  }

  /// Finds chords that join the same two vertices as another edge of a boundary. Such a chord gets a vertex in the
  /// middle.
  void part_doubled_edges() {
    std::vector<Piece> pieces = new_chords();
    if (pieces.empty()) return;
    const auto by_key = [](const Piece& a, const Piece& b) {
      return std::tuple(a.low, a.high, a.edge) < std::tuple(b.low, b.high, b.edge);
    };
    std::vector<const ChainCut*> parted;
    std::vector<Piece> sorted = pieces;
    sort_stoppable(sorted.begin(), sorted.end(), control_, by_key);
    const std::vector<std::uint8_t> is_doubled = doubled(sorted);
    for (const Piece& piece : pieces) {
      check_();
      if (!is_doubled[static_cast<std::size_t>(std::lower_bound(sorted.begin(), sorted.end(), piece, by_key) -
                                               sorted.begin())])
        continue;
      if (piece.cut->has_middle && piece.cut->kept.empty())
        add_points(*piece.cut, std::span(&piece.cut->middle, 1));
      else
        result_.essential.stays[piece.cut->nodes[(piece.first + piece.last) / 2].vertex] = 1;
    }
  }

  /// Returns the straight pieces of all cuts that stand for several pieces of the input, in the order of the cuts.
  std::vector<Piece> new_chords() {
    std::vector<Piece> pieces;
    for (const ChainCut& cut : cuts_) {
      if (!cut.points.empty()) continue;
      std::uint32_t first = 0;
      for (std::size_t i = 0; i <= cut.kept.size(); ++i) {
        check_();
        const std::uint32_t last = i < cut.kept.size() ? cut.kept[i] : static_cast<std::uint32_t>(cut.nodes.size() - 1);
        if (last - first > 1) {
          const ChainNode &a = cut.nodes[first], &b = cut.nodes[last];
          const bool is_forward = a.vertex < b.vertex;
          pieces.push_back({std::min(a.vertex, b.vertex), std::max(a.vertex, b.vertex),
                            first_of_edge(is_forward ? a.after : b.before), &cut, first, last});
        }
        first = last;
      }
    }
    return pieces;
  }

  /// For each of the chords, which are sorted, returns whether another edge of some loop joins the same vertices.
  std::vector<std::uint8_t> doubled(const std::vector<Piece>& chords) {
    IdVector<VertexId, std::uint8_t> is_end(in_.surface.vertex_count(), 0);
    for (const Piece& chord : chords) is_end[chord.low] = is_end[chord.high] = 1;
    std::vector<std::uint8_t> is_doubled(chords.size(), 0);
    const auto compare = [&](VertexId low, VertexId high, std::uint32_t edge) {
      auto chord = std::lower_bound(chords.begin(), chords.end(), std::pair(low, high),
                                    [](const Piece& c, const auto& key) { return c.key() < key; });
      for (; chord != chords.end() && chord->key() == std::pair(low, high); ++chord)
        if (chord->edge != edge) is_doubled[static_cast<std::size_t>(chord - chords.begin())] = 1;
    };
    std::vector<std::uint32_t> has_points;  // half-edges after which a loop has new vertices
    for (const Start& start : result_.starts) has_points.push_back(start.half_edge);
    sort_stoppable(has_points.begin(), has_points.end(), control_);
    for (std::size_t l = 0; l + 1 < in_.loops.loop_begin.size(); ++l)
      for_each_edge(in_.loops.loop(static_cast<std::uint32_t>(l)), [&](std::uint32_t first, std::uint32_t last) {
        const VertexId a = in_.adjacency.from(first), b = in_.adjacency.to(last);
        if (!is_end[a] || !is_end[b] || std::binary_search(has_points.begin(), has_points.end(), first)) return;
        compare(std::min(a, b), std::max(a, b), first_of_edge(a < b ? first : last));
      });
    return is_doubled;
  }

  /// Calls take(first, last) with the half-edges at the ends of each run of a loop between two vertices that stay.
  template <class Take>
  void for_each_edge(std::span<const std::uint32_t> loop, const Take& take) {
    const auto begins_an_edge = [&](std::uint32_t h) { return result_.essential[in_.adjacency.from(h)]; };
    const auto start = std::find_if(loop.begin(), loop.end(), begins_an_edge);
    if (start == loop.end()) return;
    const auto offset = static_cast<std::size_t>(start - loop.begin());
    std::uint32_t first = *start, last = *start;
    for (std::size_t i = 1; i <= loop.size(); ++i) {
      check_();
      const std::uint32_t h = loop[(offset + i) % loop.size()];
      if (begins_an_edge(h)) {
        take(first, last);
        first = h;
      }
      last = h;
    }
  }

  const PatchBoundaries& in_;
  const IdVector<PatchId, PatchSurface>& surfaces_;
  const CurveRules& rules_;
  StopCheck check_;
  RunControl& control_;
  BoundaryChains chains_;
  std::vector<ChainCut> cuts_;
  CurveCuts result_;
};

}  // namespace

std::span<const VertexId> CurveCuts::between(std::uint32_t h) const {
  const auto start = std::lower_bound(starts.begin(), starts.end(), h,
                                      [](const Start& s, std::uint32_t half_edge) { return s.half_edge < half_edge; });
  if (start == starts.end() || start->half_edge != h) return {};
  return std::span(lists).subspan(start->begin, start->end - start->begin);
}

CurveCuts cut_curves(const PatchBoundaries& boundaries, const IdVector<PatchId, PatchSurface>& surfaces,
                     const CurveRules& rules, RunControl& control) {
  return CurveCutter(boundaries, surfaces, rules, control).run();
}

}  // namespace remesh
