#include "core/free_form/kept_volume.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <tuple>

#include "core/base/stoppable.h"
#include "core/base/union_find.h"

namespace remesh {
namespace {

double volume_under(const Vec3& a, const Vec3& b, const Vec3& c) { return dot(a, cross(b, c)) / 6; }

}  // namespace

KeptVolume::KeptVolume(const OrderedInput& input, RunControl& control) {
  const std::size_t n = input.faces.size();
  control.memory().ask_for<double>(8 * n);
  UnionFind joined(n);
  StopCheck check(control);
  // The edges with other than two faces of components, as (component, one end, other end, direction).
  std::vector<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, int>> open;
  for (std::uint32_t h = 0; h < 3 * n; ++h) {
    check();
    if (input.twins[h] != kNone) joined.join(h / 3, input.twins[h] / 3);
  }
  IdVector<VertexId, std::uint32_t> first(input.positions.size(), kNone);
  const auto is_held = [&](VertexId v) { return !input.is_held.empty() && input.is_held[v.value] != 0; };
  for (FaceId f(0); f.value < n; ++f.value)
    for (std::uint32_t k = 0; k < 3; ++k) {
      check();
      const VertexId v = input.faces[f][k], w = input.faces[f][(k + 1) % 3];
      // Faces that meet only at a vertex, or at an edge with many faces, bound one solid as well.
      if (first[v] == kNone) first[v] = f.value;
      joined.join(first[v], f.value);
      if (input.twins[3 * f.value + k] != kNone || (is_held(v) && is_held(w))) continue;
      open.emplace_back(f.value, std::min(v, w).value, std::max(v, w).value, v < w ? 1 : -1);
    }
  for (std::uint32_t f = 0; f < n; ++f) component_.push_back(joined.find(f));
  volume_.assign(n, 0);
  for (auto& [component, v, w, direction] : open) component = component_[component];
  sort_stoppable(open.begin(), open.end(), control, std::less<>());
  for (std::size_t i = 0; i < open.size();) {
    check();
    const auto [component, v, w, direction] = open[i];
    int sum = 0;
    for (;
         i < open.size() && std::get<0>(open[i]) == component && std::get<1>(open[i]) == v && std::get<2>(open[i]) == w;
         ++i)
      sum += std::get<3>(open[i]);
    if (sum != 0) volume_[component] = std::numeric_limits<double>::quiet_NaN();
  }
  for (FaceId f(0); f.value < n; ++f.value) {
    check();
    const Triangle& t = input.faces[f];
    volume_[component_[f.value]] += volume_under(input.positions[t[0]], input.positions[t[1]], input.positions[t[2]]);
  }
}

IdVector<VertexId, Vec3> KeptVolume::places(const Sheet& sheet, const IdVector<VertexId, double>& weights,
                                            double tolerance, RunControl& control) const {
  constexpr int kSteps = 4;
  constexpr double kFound = 1e-6;  // this share of what was missing at first may still be missing
  const std::size_t n = sheet.positions.size();
  IdVector<VertexId, Vec3> ways(n);
  IdVector<VertexId, std::uint32_t> component(n, 0);
  StopCheck check(control);
  for (FaceId f(0); f.value < sheet.faces.size(); ++f.value) {
    check();
    const Corners3 at = sheet.corners_of(f);
    for (const VertexId v : sheet.faces[f]) {
      ways[v] += cross(at[1] - at[0], at[2] - at[0]);
      component[v] = component_[sheet.origin[f].value];
    }
  }
  for (VertexId v(0); v.value < n; ++v.value) ways[v] = weights[v] > 0 ? weights[v] * normalized(ways[v]) : Vec3();
  // Newton's method for the distance that gives each component its volume. The volume is nearly linear in the distance.
  std::vector<double> distance(component_.size(), 0);
  IdVector<VertexId, Vec3> places;
  std::vector<double> missing, gain;
  const auto move = [&] {
    places = sheet.positions;
    for (VertexId v(0); v.value < n; ++v.value)
      if (weights[v] > 0) places[v] += distance[component[v]] * ways[v];
  };
  const auto measure = [&] {
    missing = volume_;
    gain.assign(volume_.size(), 0);
    for (FaceId f(0); f.value < sheet.faces.size(); ++f.value) {
      check();
      const Triangle& t = sheet.faces[f];
      const Vec3 &a = places[t[0]], &b = places[t[1]], &c = places[t[2]];
      const std::uint32_t at = component[t[0]];
      missing[at] -= volume_under(a, b, c);
      gain[at] += dot(ways[t[0]] + ways[t[1]] + ways[t[2]], cross(b - a, c - a)) / 6;
    }
  };
  move();
  measure();
  const std::vector<double> at_first = missing;
  for (int step = 0; step < kSteps; ++step) {
    for (std::size_t i = 0; i < distance.size(); ++i) {
      const double further = missing[i] / gain[i];
      if (std::isfinite(further)) distance[i] += further;
    }
    move();
    measure();
  }
  for (std::size_t i = 0; i < distance.size(); ++i)
    if (!(std::fabs(distance[i]) <= tolerance / 2 && std::fabs(missing[i]) <= kFound * std::fabs(at_first[i])))
      distance[i] = 0;
  move();
  return places;
}

}  // namespace remesh
