#include "core/mending/details/tiny_components.h"

#include <algorithm>
#include <cmath>

#include "core/base/stoppable.h"
#include "core/base/union_find.h"
#include "core/geometry/trees/box_tree.h"

namespace remesh {
namespace {

using Weights = std::array<double, 3>;

Vec3 weighted(const Corners3& corners, const Weights& weights) {
  return weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
}

/// Returns the weights of the point of a triangle that is nearest to a place.
Weights nearest_weights(const Vec3& place, const Corners3& corners) {
  Weights best{1, 0, 0};
  const auto take = [&](const Weights& weights) {
    if (norm_squared(weighted(corners, weights) - place) < norm_squared(weighted(corners, best) - place))
      best = weights;
  };
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    const Vec3 side = corners[next] - corners[k];
    const double squared = norm_squared(side);
    const double at = squared > 0 ? std::clamp(dot(place - corners[k], side) / squared, 0.0, 1.0) : 0;
    Weights on_side{0, 0, 0};
    on_side[k] = 1 - at;
    on_side[next] = at;
    take(on_side);
  }
  const Vec3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
  const double squared = norm_squared(normal);
  if (!(squared > 0)) return best;
  const double second = dot(cross(corners[2] - place, corners[0] - place), normal) / squared;
  const double third = dot(cross(corners[0] - place, corners[1] - place), normal) / squared;
  if (second > 0 && third > 0 && second + third < 1) take({1 - second - third, second, third});
  return best;
}

/// Returns whether all labels of some faces are among `labels`.
bool are_labels_among(const std::vector<std::uint32_t>& labels, const std::vector<FaceId>& faces,
                      std::span<const std::uint32_t> label_of) {
  return std::all_of(faces.begin(), faces.end(),
                     [&](FaceId f) { return std::binary_search(labels.begin(), labels.end(), label_of[f.value]); });
}

}  // namespace

TinyComponents find_tiny_components(const DetailRules& rules, RunControl& control) {
  const std::size_t n = rules.positions.size();
  UnionFind parts(n);
  StopCheck check(control);
  for (const Triangle& t : rules.faces) {
    check();
    parts.join(t[0].value, t[1].value);
    parts.join(t[0].value, t[2].value);
  }
  std::vector<Box3> box(n);
  std::vector<std::uint8_t> is_small(n, 1);
  for (std::uint32_t v = 0; v < n; ++v) {
    check();
    const std::uint32_t part = parts.find(v);
    box[part].add(rules.positions[v]);
    if (!rules.is_fixed.empty() && rules.is_fixed[v] != 0) is_small[part] = 0;
  }
  for (std::uint32_t v = 0; v < n; ++v)
    if (parts.find(v) == v && !(box[v].diagonal() <= rules.size)) is_small[v] = 0;

  const auto part_of = [&](FaceId f) { return parts.find(rules.faces[f.value][0].value); };
  std::vector<std::uint32_t> labels;
  std::vector<std::vector<FaceId>> faces;
  std::vector<std::uint32_t> number(n, kNone);
  bool is_any_left = false;
  for (std::uint32_t i = 0; i < rules.faces.size(); ++i) {
    check();
    const FaceId f(i);
    const std::uint32_t part = part_of(f);
    if (is_small[part] == 0) {
      is_any_left = true;
      if (!rules.label.empty()) labels.push_back(rules.label[f.value]);
      continue;
    }
    if (number[part] == kNone) {
      number[part] = static_cast<std::uint32_t>(faces.size());
      faces.emplace_back();
    }
    faces[number[part]].push_back(f);
  }
  TinyComponents components;
  if (!is_any_left || faces.empty()) return components;
  sort_unique(labels, control);
  components.of_face.assign(rules.faces.size(), kNone);
  for (const std::vector<FaceId>& of_part : faces) {
    check();
    if (!rules.label.empty() && !are_labels_among(labels, of_part, rules.label)) continue;
    std::vector<VertexId>& vertices = components.vertices.emplace_back();
    for (const FaceId f : of_part) {
      components.of_face[f.value] = static_cast<std::uint32_t>(components.count() - 1);
      vertices.insert(vertices.end(), rules.faces[f.value].begin(), rules.faces[f.value].end());
    }
    sort_unique(vertices);
  }
  if (components.count() == 0) components.of_face.clear();
  return components;
}

std::vector<std::optional<PointOfTriangle>> points_near_tiny_components(const TinyComponents& components,
                                                                        std::span<const Vec3> positions,
                                                                        std::span<const Corners3> kept, double allowed,
                                                                        RunControl& control) {
  const auto entries = BoxTree<NoTag>::make_entries(kept.size(), control, [&](std::size_t i, auto& entry) {
    for (const Vec3& p : kept[i]) entry.box.add(p);
  });
  const BoxTree<NoTag> tree(entries, control);
  std::vector<std::optional<PointOfTriangle>> points;
  for (const std::vector<VertexId>& component : components.vertices) {
    control.check();
    Box3 box;
    for (const VertexId v : component) box.add(positions[v.value]);
    const Vec3 middle = 0.5 * (box.min + box.max);
    double best = HUGE_VAL;
    PointOfTriangle nearest{};
    tree.search(
        best, [&](const auto& entry) { return squared_distance(entry.box, middle); },
        [&](std::size_t slot) {
          const std::size_t triangle = tree.number(slot);
          const Weights weights = nearest_weights(middle, kept[triangle]);
          const double squared = norm_squared(weighted(kept[triangle], weights) - middle);
          if (!(squared < best)) return;
          best = squared;
          nearest = {triangle, weights};
        });
    points.emplace_back();
    if (best == HUGE_VAL) continue;
    const Vec3 point = weighted(kept[nearest.triangle], nearest.weights);
    if (std::all_of(component.begin(), component.end(),
                    [&](VertexId v) { return norm(positions[v.value] - point) <= allowed; }))
      points.back() = nearest;
  }
  return points;
}

}  // namespace remesh
