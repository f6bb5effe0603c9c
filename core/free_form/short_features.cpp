#include "core/free_form/short_features.h"

#include <utility>
#include <vector>

#include "core/base/stoppable.h"
#include "core/free_form/sheet.h"

namespace remesh {
namespace {

constexpr double kShortTolerances = 8;
constexpr std::size_t kFewEdges = 4;

/// The edges that stay, as a graph.
class BarrierGraph {
 public:
  BarrierGraph(OrderedInput& input, RunControl& control) : input_(input), check_(control) {
    const auto for_barriers = [&](const auto& take) {
      for (std::uint32_t h = 0; h < input.edges.size(); ++h) {
        check_();
        const std::uint32_t twin = input.twins[h];
        if (twin == kNone || (h < twin && input.edges[h] != FreeForm::Edge::kSmooth)) take(h);
      }
    };
    begin_.assign(input.positions.size() + 1, 0);
    for_barriers([&](std::uint32_t h) {
      ++begin_[from(h).value + 1];
      ++begin_[to(h).value + 1];
    });
    for (std::size_t v = 0; v + 1 < begin_.size(); ++v) begin_[v + 1] += begin_[v];
    edges_.resize(begin_.back());
    std::vector<std::uint32_t> filled(begin_.begin(), begin_.end() - 1);
    for_barriers([&](std::uint32_t h) {
      edges_[filled[from(h).value]++] = h;
      edges_[filled[to(h).value]++] = h;
    });
    for (VertexId v(0); v.value < input.positions.size(); ++v.value)
      degree_.push_back(begin_[v.value + 1] - begin_[v.value]);
  }

  /// Drops short chains with loose ends, and those that get a loose end by that.
  std::uint64_t drop_loose(double short_length) {
    std::vector<VertexId> loose;
    for (VertexId v(0); v.value < degree_.size(); ++v.value)
      if (degree_[v] == 1) loose.push_back(v);
    std::uint64_t dropped = 0;
    for (std::size_t i = 0; i < loose.size(); ++i) {
      if (degree_[loose[i]] != 1) continue;
      const VertexId end = trace(loose[i]);
      if (chain_.empty() || (length_ >= short_length && chain_.size() >= kFewEdges)) continue;
      dropped += drop();
      if (degree_[end] == 1) loose.push_back(end);
    }
    return dropped;
  }

  /// Drops short chains that are closed.
  std::uint64_t drop_closed(double short_length) {
    std::uint64_t dropped = 0;
    IdVector<VertexId, std::uint8_t> is_seen(degree_.size(), 0);
    for (VertexId v(0); v.value < degree_.size(); ++v.value) {
      if (degree_[v] != 2 || is_seen[v] != 0) continue;
      const VertexId end = trace(v);
      for (const std::uint32_t h : chain_) is_seen[from(h)] = is_seen[to(h)] = 1;
      if (end == v && degree_[end] == 2 && length_ < short_length) dropped += drop();
    }
    return dropped;
  }

 private:
  VertexId from(std::uint32_t h) const { return input_.faces[FaceId(h / 3)][h % 3]; }
  VertexId to(std::uint32_t h) const { return input_.faces[FaceId(h / 3)][(h % 3 + 1) % 3]; }
  bool is_feature(std::uint32_t h) const {
    return input_.twins[h] != kNone && input_.edges[h] == FreeForm::Edge::kFeature;
  }
  bool is_there(std::uint32_t h) const {
    return input_.twins[h] == kNone || input_.edges[h] != FreeForm::Edge::kSmooth;
  }

  /// Follows a chain of features from a vertex until it branches, ends or closes.
  /// Output: the last vertex; `chain_` and `length_` have the edges and their length.
  VertexId trace(VertexId start) {
    chain_.clear();
    length_ = 0;
    VertexId at = start;
    std::uint32_t last = kNone;
    do {
      check_();
      std::uint32_t following = kNone;
      for (std::uint32_t i = begin_[at.value]; i < begin_[at.value + 1] && following == kNone; ++i)
        if (edges_[i] != last && is_there(edges_[i])) following = edges_[i];
      if (following == kNone || !is_feature(following)) break;
      chain_.push_back(following);
      last = following;
      const VertexId other = from(following) == at ? to(following) : from(following);
      length_ += norm(input_.positions[other] - input_.positions[at]);
      at = other;
    } while (degree_[at] == 2 && at != start);
    return at;
  }

  std::uint64_t drop() {
    for (const std::uint32_t h : chain_) {
      input_.edges[h] = input_.edges[input_.twins[h]] = FreeForm::Edge::kSmooth;
      --degree_[from(h)];
      --degree_[to(h)];
    }
    return chain_.size();
  }

  OrderedInput& input_;
  StopCheck check_;
  std::vector<std::uint32_t> begin_, edges_;  ///< the half-edges of the barriers at each vertex
  IdVector<VertexId, std::uint32_t> degree_;
  std::vector<std::uint32_t> chain_;
  double length_ = 0;
};

}  // namespace

std::uint64_t drop_short_features(OrderedInput& input, double tolerance, RunControl& control) {
  BarrierGraph barriers(input, control);
  const double short_length = kShortTolerances * tolerance;
  const std::uint64_t loose = barriers.drop_loose(short_length);
  return loose + barriers.drop_closed(short_length);
}

}  // namespace remesh
