#include "core/mending/details/detail_shapes.h"

#include <cstddef>
#include <tuple>

#include "core/base/ids.h"

namespace remesh {
namespace {

/// The cosine of the largest angle by which a face that is no detail may turn.
constexpr double kTurnedCosine = 0.5;

}  // namespace

bool may_become(const TriangleShape& before, const TriangleShape& after, const DetailRules& rules) {
  if (!(after.height > 0)) return false;
  if (before.height <= rules.noise) return true;
  const double cosine = dot(before.twice_area, after.twice_area) / (norm(before.twice_area) * norm(after.twice_area));
  return before.height >= rules.size ? cosine > kTurnedCosine : cosine > 0;
}

std::vector<Spoke> spokes_of(std::uint32_t node, const std::vector<PresentTriangle>& triangles,
                             const DetailComplex& complex, const DetailRules& rules) {
  struct Use {
    std::uint32_t to;
    int direction;
    FaceId face;
  };
  std::vector<Use> uses;
  for (const PresentTriangle& t : triangles) {
    const int at = t.at(node);
    uses.push_back({t.corners[(at + 1) % 3], 1, complex.face_of(t.index)});
    uses.push_back({t.corners[(at + 2) % 3], -1, complex.face_of(t.index)});
  }
  std::sort(uses.begin(), uses.end(), [](const Use& a, const Use& b) {
    return std::tie(a.to, a.direction, a.face) < std::tie(b.to, b.direction, b.face);
  });
  std::vector<Spoke> spokes;
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    Spoke spoke{uses[begin].to};
    for (end = begin; end < uses.size() && uses[end].to == spoke.to; ++end) {
      ++spoke.faces;
      spoke.balance += uses[end].direction;
      const FaceId f = uses[begin].face, g = uses[end].face;
      if (rules.patch[f.value] != rules.patch[g.value]) spoke.is_crease = true;
      if (!rules.label.empty() && rules.label[f.value] != rules.label[g.value]) spoke.is_border = true;
    }
    spoke.is_border = spoke.is_border || spoke.faces != 2 || spoke.balance != 0;
    spoke.is_crease = spoke.is_crease || spoke.is_border;
    spokes.push_back(spoke);
  }
  return spokes;
}

const Spoke* find_spoke(const std::vector<Spoke>& spokes, std::uint32_t to) {
  const auto at = std::lower_bound(spokes.begin(), spokes.end(), to,
                                   [](const Spoke& s, std::uint32_t node) { return s.to < node; });
  return at != spokes.end() && at->to == to ? &*at : nullptr;
}

std::uint32_t third(const PresentTriangle& t, std::uint32_t a, std::uint32_t b) {
  for (const std::uint32_t c : t.corners)
    if (c != a && c != b) return c;
  return kNone;
}

bool do_see_common_edge(const FacesAtEdge& a, const FacesAtEdge& b) {
  const auto edges_of = [](const FacesAtEdge& faces) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (const PresentTriangle& t : faces.at_node) {
      const int at = t.at(faces.node);
      if (!t.has(faces.without)) edges.push_back(std::minmax(t.corners[(at + 1) % 3], t.corners[(at + 2) % 3]));
    }
    return edges;
  };
  auto of_a = edges_of(a);
  std::sort(of_a.begin(), of_a.end());
  const auto of_b = edges_of(b);
  return std::any_of(of_b.begin(), of_b.end(),
                     [&](const auto& edge) { return std::binary_search(of_a.begin(), of_a.end(), edge); });
}

bool would_fold(const FacesAtEdge& moved, const FacesAtEdge& kept, std::uint32_t end, const Vec3& target,
                const DetailComplex& complex, const DetailRules& rules) {
  const Vec3 along = normalized(complex.place(end) - target);
  const auto for_each_side = [&](const FacesAtEdge& faces, const auto& body) {
    for (const PresentTriangle& t : faces.at_node) {
      if (!t.has(end) || t.has(faces.without) || TriangleShape(places_of(t, complex)).height < rules.size) continue;
      const Vec3 out = complex.place(third(t, faces.node, end)) - target;
      body(out - dot(out, along) * along);
    }
  };
  bool is_any = false;
  for_each_side(moved, [&](const Vec3& a) {
    for_each_side(kept, [&](const Vec3& b) { is_any = is_any || dot(a, b) > kFoldedCosine * norm(a) * norm(b); });
  });
  return is_any;
}

}  // namespace remesh
