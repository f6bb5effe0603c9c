#include "core/free_form/ordered_input.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"

namespace remesh {
namespace {

/// Puts two empty bits before each of the lowest 21 bits.
std::uint64_t with_gaps(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffff;
  x = (x | x << 16) & 0x1f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  x = (x | x << 2) & 0x1249249249249249;
  return x;
}

/// Returns three axes at right angles with a length of 1, others for each turn. They come from quaternions of small
/// whole numbers.
std::array<Vec3, 3> axes_of(int turn) {
  constexpr std::array<std::array<double, 4>, 6> kQuaternions{
      {{8, 1, 0, 0}, {5, 2, 1, 3}, {4, -1, 3, 1}, {6, 3, -2, 1}, {3, 2, 2, -1}, {7, -2, 3, 4}}};
  const auto [w, x, y, z] = kQuaternions[static_cast<std::size_t>(turn) % kQuaternions.size()];
  const double scale = 1 / (w * w + x * x + y * y + z * z);
  return {scale * Vec3{w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)},
          scale * Vec3{2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)},
          scale * Vec3{2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z}};
}

}  // namespace

std::vector<VertexId> order_along_curve(const IdVector<VertexId, Vec3>& places, std::vector<VertexId> vertices,
                                        int turn, RunControl& control) {
  struct Coded {
    std::uint64_t code;
    VertexId vertex;
  };
  // Coordinates are within 1, so turned ones are within sqrt(3).
  constexpr double kReach = 1.75, kCells = 0x1p20;
  const std::array<Vec3, 3> axes = axes_of(turn);
  std::vector<Coded> coded(vertices.size());
  for_blocks(vertices.size(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::uint64_t code = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double cell = (dot(axes[axis], places[vertices[i]]) / kReach + 1) * kCells;
        code |= with_gaps(static_cast<std::uint64_t>(std::clamp(cell, 0.0, 2 * kCells - 1))) << axis;
      }
      coded[i] = {code, vertices[i]};
    }
  });
  sort_stoppable(coded.begin(), coded.end(), control, [&](const Coded& a, const Coded& b) {
    if (a.code != b.code) return a.code < b.code;
    return std::pair(places[a.vertex], a.vertex) < std::pair(places[b.vertex], b.vertex);
  });
  for (std::size_t i = 0; i < coded.size(); ++i) vertices[i] = coded[i].vertex;
  return vertices;
}

OrderedInput in_order(const FreeForm& input, RunControl& control) {
  OrderedInput ordered;
  std::vector<VertexId> all;
  all.reserve(input.positions.size());
  for (VertexId v(0); v.value < input.positions.size(); ++v.value) all.push_back(v);
  ordered.vertex_before.items() = order_along_curve(input.positions, std::move(all), 0, control);
  IdVector<VertexId, VertexId> number(input.positions.size());
  StopCheck check(control);
  ordered.positions.reserve(input.positions.size());
  for (const VertexId v : ordered.vertex_before) {
    check();
    number[v] = ordered.positions.push_back(input.positions[v]);
    if (!input.is_held.empty()) ordered.is_held.push_back(input.is_held[v.value]);
  }
  struct Face {
    Triangle corners;
    std::uint32_t first;  ///< the half-edge before that is the first one now
  };
  control.memory().ask_for<Face>(input.faces.size());
  std::vector<Face> faces;
  faces.reserve(input.faces.size());
  for (FaceId f(0); f.value < input.faces.size(); ++f.value) {
    check();
    const Triangle& t = input.faces[f];
    const Triangle now{number[t[0]], number[t[1]], number[t[2]]};
    const auto k = static_cast<std::uint32_t>(std::min_element(now.begin(), now.end()) - now.begin());
    faces.push_back({{now[k], now[(k + 1) % 3], now[(k + 2) % 3]}, 3 * f.value + k});
  }
  sort_stoppable(faces.begin(), faces.end(), control, [](const Face& a, const Face& b) {
    return std::pair(a.corners, a.first) < std::pair(b.corners, b.first);
  });
  // The half-edges that begin at the corners of the faces, before and now.
  std::vector<std::uint32_t> now(3 * faces.size());
  const auto before = [&](std::size_t f, std::uint32_t k) {
    const std::uint32_t first = faces[f].first;
    return first - first % 3 + (first % 3 + k) % 3;
  };
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (std::uint32_t k = 0; k < 3; ++k) now[before(f, k)] = static_cast<std::uint32_t>(3 * f + k);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    check();
    ordered.faces.push_back(faces[f].corners);
    ordered.face_before.push_back(FaceId(faces[f].first / 3));
    if (!input.shares.empty()) ordered.shares.push_back(input.shares[faces[f].first / 3]);
    if (!input.is_of_plane.empty()) ordered.is_of_plane.push_back(input.is_of_plane[faces[f].first / 3]);
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t twin = input.twins[before(f, k)];
      ordered.twins.push_back(twin == kNone ? kNone : now[twin]);
      ordered.edges.push_back(input.edges[before(f, k)]);
    }
  }
  return ordered;
}

}  // namespace remesh
