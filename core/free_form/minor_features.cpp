#include "core/free_form/minor_features.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"
#include "core/free_form/sheet.h"

namespace remesh {
namespace {

constexpr double kShortTolerances = 8;
constexpr std::size_t kFewEdges = 4;
/// A feature whose faces have normals with at least this cosine between them may belong to a rounded edge: 60 degrees.
constexpr double kRoundedCosine = 0.5;
/// Other edges are looked for within so many tolerances of the middle of a feature, and over so many faces.
constexpr double kNearTolerances = 4;
constexpr std::size_t kNearFaces = 64;
/// Another edge runs beside the feature if the angle between the two has at least the first cosine, and that between
/// the feature and the way to the nearest point of the other edge less than the second one.
constexpr double kAlongCosine = 0.7, kBesideCosine = 0.4;
constexpr std::size_t kEdgesPerBlock = 1024;

/// The facets of rounded edges.
class RoundedEdges {
 public:
  RoundedEdges(const OrderedInput& input, double tolerance) : input_(input), near_(kNearTolerances * tolerance) {}

  /// Returns whether another feature, border or open edge runs beside a feature, so that the two are facets of a
  /// rounded edge, or as good as that within the tolerance.
  bool is_part(std::uint32_t h) const {
    const std::uint32_t twin = input_.twins[h];
    const FaceId f(h / 3), g(twin / 3);
    const Vec3 n = normal(f), m = normal(g);
    if (dot(n, m) < kRoundedCosine * norm(n) * norm(m)) return false;
    const double near =
        input_.shares.empty() ? near_ : near_ * std::min(input_.shares[f.value], input_.shares[g.value]);
    const Vec3 &a = position(h), &b = position(after(h)), middle = 0.5 * (a + b);
    std::vector<FaceId> faces{f, g};
    for (std::size_t i = 0; i < faces.size(); ++i)
      for (std::uint32_t e = 3 * faces[i].value; e < 3 * faces[i].value + 3; ++e) {
        if (e == h || e == twin) continue;
        const Vec3 to = nearest_point(middle, e) - middle;
        if (norm(to) > near) continue;
        const bool is_smooth = input_.twins[e] != kNone && input_.edges[e] == FreeForm::Edge::kSmooth;
        if (!is_smooth && is_along(e, b - a) && std::fabs(dot(to, b - a)) < kBesideCosine * norm(to) * norm(b - a))
          return true;
        if (input_.twins[e] == kNone || input_.edges[e] == FreeForm::Edge::kBorder) continue;
        const FaceId next(input_.twins[e] / 3);
        if (faces.size() < kNearFaces && std::find(faces.begin(), faces.end(), next) == faces.end())
          faces.push_back(next);
      }
    return false;
  }

 private:
  static std::uint32_t after(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  const Vec3& position(std::uint32_t h) const { return input_.positions[input_.faces[FaceId(h / 3)][h % 3]]; }
  Vec3 normal(FaceId f) const {
    const Vec3& a = position(3 * f.value);
    return cross(position(3 * f.value + 1) - a, position(3 * f.value + 2) - a);
  }
  bool is_along(std::uint32_t h, const Vec3& way) const {
    const Vec3 along = position(after(h)) - position(h);
    return std::fabs(dot(along, way)) >= kAlongCosine * norm(along) * norm(way);
  }
  Vec3 nearest_point(const Vec3& p, std::uint32_t h) const {
    const Vec3 &a = position(h), along = position(after(h)) - a;
    return a + std::clamp(dot(p - a, along) / dot(along, along), 0.0, 1.0) * along;
  }

  const OrderedInput& input_;
  double near_;
};

/// Drops the features that make rounded edges together.
std::uint64_t drop_rounded(OrderedInput& input, double tolerance, RunControl& control) {
  const RoundedEdges rounded(input, tolerance);
  const auto is_dropped = [&](std::size_t i) {
    const auto h = static_cast<std::uint32_t>(i);
    return input.edges[h] == FreeForm::Edge::kFeature && input.twins[h] != kNone && h < input.twins[h] &&
           rounded.is_part(h);
  };
  const auto dropped = select_ids<std::uint32_t>(input.edges.size(), kEdgesPerBlock, control, is_dropped);
  for (const std::uint32_t h : dropped) input.edges[h] = input.edges[input.twins[h]] = FreeForm::Edge::kSmooth;
  return dropped.size();
}

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

std::uint64_t drop_minor_features(OrderedInput& input, double tolerance, RunControl& control) {
  const std::uint64_t rounded = drop_rounded(input, tolerance, control);
  BarrierGraph barriers(input, control);
  const double short_length = kShortTolerances * tolerance;
  const std::uint64_t loose = barriers.drop_loose(short_length);
  return rounded + loose + barriers.drop_closed(short_length);
}

}  // namespace remesh
