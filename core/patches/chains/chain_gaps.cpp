#include "core/patches/chains/chain_gaps.h"

#include <algorithm>
#include <cmath>

#include "core/base/stoppable.h"
#include "core/geometry/triangles/distances.h"

namespace remesh {
namespace {

/// A chain may move by this part of its distance to another edge: in general; if the edge has an end in common with the
/// chain; and if the edge has such an end and does not move itself.
constexpr double kOfGap = 0.25, kOfWedge = 0.5, kOfFixedWedge = 0.75;

}  // namespace

ChainGaps::ChainGaps(const Surface& surface, const Adjacency& adjacency, const BoundaryLoops& loops,
                     const EssentialVertices& essential, const BoundaryChains& chains,
                     const IdVector<PatchId, std::uint8_t>& is_searched, RunControl& control)
    : surface_(surface), chains_(chains), chain_of_(surface.vertex_count(), kNone) {
  StopCheck check(control);
  for (std::uint32_t c = 0; c < chains.size(); ++c)
    for (const ChainNode& node : chains[c].first(chains[c].size() - 1)) {
      check();
      // Where a ring begins, its first node counts as inside the chain, too.
      if (&node != &chains[c].front() || node.before != kNone) chain_of_[node.vertex] = c;
    }
  of_patch_.assign(is_searched.size(), kNone);
  std::vector<BoxTree<ChainTag>::Entry> boxes;
  for (PatchId p(0); p.value < is_searched.size(); ++p.value) {
    if (!is_searched[p]) continue;
    of_patch_[p] = static_cast<std::uint32_t>(searched_.size());
    PatchPieces& patch = searched_.emplace_back();
    for (std::uint32_t l = loops.patch_begin[p.value]; l < loops.patch_begin[p.value + 1]; ++l) {
      VertexId first, last;
      for (const std::uint32_t h : loops.loop(l)) {
        check();
        const VertexId v = adjacency.from(h);
        if (!essential[v]) continue;
        if (last.is_valid())
          patch.pieces.push_back({last, v});
        else
          first = v;
        last = v;
      }
      if (last.is_valid()) patch.pieces.push_back({last, first});
    }
    boxes.assign(patch.pieces.size(), {});
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      boxes[i].box.add(surface.local[patch.pieces[i].from]);
      boxes[i].box.add(surface.local[patch.pieces[i].to]);
      boxes[i].tag.chain = chain_of(patch.pieces[i]);
    }
    patch.tree = BoxTree<ChainTag>(boxes, control);
  }
}

/// Returns the chain of a piece, if a node inside the piece tells it.
std::uint32_t ChainGaps::chain_of(const Piece& piece) const {
  return chain_of_[piece.from] != kNone ? chain_of_[piece.from] : chain_of_[piece.to];
}

bool ChainGaps::is_of_chain(const Piece& piece, std::uint32_t chain) const {
  if (chain_of(piece) != kNone) return chain_of(piece) == chain;
  const auto nodes = chains_[chain];
  if (nodes.size() != 2) return false;
  const VertexId a = nodes.front().vertex, b = nodes.back().vertex;
  return (piece.from == a && piece.to == b) || (piece.from == b && piece.to == a);
}

/// Returns whether the pieces of another chain do not limit a chain.
bool ChainGaps::is_out_of_the_way(std::uint32_t chain, std::uint32_t other) const {
  return other == chain || (other < chains_.size() && goes_on_from(chain, other));
}

/// Returns whether two chains have a common end, and no acute angle between them at any common end.
bool ChainGaps::goes_on_from(std::uint32_t chain, std::uint32_t other) const {
  const auto direction = [&](std::span<const ChainNode> nodes, bool at_front) {
    const VertexId end = at_front ? nodes.front().vertex : nodes.back().vertex;
    const VertexId next = at_front ? nodes[1].vertex : nodes[nodes.size() - 2].vertex;
    return surface_.local[next] - surface_.local[end];
  };
  bool is_joined = false;
  for (const bool at_front : {true, false})
    for (const bool at_others_front : {true, false}) {
      const auto nodes = chains_[chain], others = chains_[other];
      const VertexId end = at_front ? nodes.front().vertex : nodes.back().vertex;
      if (end != (at_others_front ? others.front().vertex : others.back().vertex)) continue;
      if (dot(direction(nodes, at_front), direction(others, at_others_front)) > 0) return false;
      is_joined = true;
    }
  return is_joined;
}

/// Returns the part of the distance to the nearest place of a piece that the chain may move, or infinity if the piece
/// does not count.
double ChainGaps::part_of_distance(std::uint32_t chain, const Piece& piece, const Vec3& nearest) const {
  const std::uint32_t other = chain_of(piece);
  if (is_of_chain(piece, chain) || is_out_of_the_way(chain, other)) return HUGE_VAL;
  for (const VertexId end : {chains_[chain].front().vertex, chains_[chain].back().vertex}) {
    if (piece.from != end && piece.to != end) continue;
    if (nearest == surface_.local[end]) return HUGE_VAL;
    return other == kNone ? kOfFixedWedge : kOfWedge;
  }
  return kOfGap;
}

double ChainGaps::room(std::uint32_t chain, PatchId patch, const Vec3& place, double limit) const {
  const PatchPieces& searched = searched_[of_patch_[patch]];
  const Vec3 local = surface_.to_local(place);
  double best = limit / surface_.unit * (limit / surface_.unit);
  const double unlimited = best;
  searched.tree.search(
      best,
      [&](const auto& entry) {
        // A long chain is never searched for its own pieces.
        return is_out_of_the_way(chain, entry.tag.chain) ? HUGE_VAL
                                                         : kOfGap * kOfGap * squared_distance(entry.box, local);
      },
      [&](std::size_t slot) {
        const Piece& piece = searched.pieces[searched.tree.number(slot)];
        const Vec3 nearest = nearest_on_segment(local, surface_.local[piece.from], surface_.local[piece.to]);
        const double part = part_of_distance(chain, piece, nearest);
        if (part < 1) best = std::min(best, part * part * norm_squared(nearest - local));
      });
  return best < unlimited ? std::sqrt(best) * surface_.unit : limit;
}

}  // namespace remesh
