#include "core/mending/weld/bending_noise.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>

#include "core/base/blocks.h"
#include "core/geometry/planes/plane.h"

namespace remesh {
namespace {

/// Only neighbours that are at least this many tolerances high can show noise.
constexpr double kWitness = 8;
/// If more faces than this meet at an edge, the edge is ignored.
constexpr std::size_t kMaxAround = 8;

constexpr std::size_t kNoiseBlock = 4096;

/// Collects the amounts by which faces bend, as distances. Amounts that differ by less than about one part in a
/// thousand may count as one. No more than kBendsOfNoise different amounts are collected, because this number proves
/// that the bends are noise and not part of the shape.
class DifferentBends {
 public:
  void add(double distance, double floor, double tolerance) {
    if (distance > floor && distance <= tolerance) add(std::bit_cast<std::uint64_t>(distance) >> kForgotten);
  }
  void add(const DifferentBends& others) {
    for (std::size_t i = 0; i < others.count_; ++i) add(others.keys_[i]);
  }
  std::size_t count() const { return count_; }

 private:
  /// The remaining bits of a double distinguish values that differ by one part in a thousand.
  static constexpr int kForgotten = 42;

  void add(std::uint64_t key) {
    const auto end = keys_.begin() + static_cast<std::ptrdiff_t>(count_);
    if (count_ < keys_.size() && std::find(keys_.begin(), end, key) == end) keys_[count_++] = key;
  }

  std::array<std::uint64_t, kBendsOfNoise> keys_{};
  std::size_t count_ = 0;
};

}  // namespace

bool is_noise_present(const Surface& surface, const Adjacency& adjacency, const FaceGeometries& geometry, double floor,
                      double tolerance, std::size_t amounts, RunControl& control) {
  const auto is_witness = [&](FaceId f) { return geometry[f].height >= kWitness * tolerance; };
  const auto bend = [&](FaceId of, FaceId against) {
    const Plane plane{face_centre(surface, against), geometry[against].normal};
    double most = 0;
    for (const VertexId v : surface.face(of)) {
      most = std::max(most, std::fabs(plane.distance(surface.local[v])));
      if (most > tolerance) break;  // such a bend is no rounding, however large the other bends are
    }
    return most;
  };
  const auto look_at_polygon = [&](DifferentBends& bends, FaceId f) {
    if (surface.face(f).size() > 3 && is_witness(f)) bends.add(bend(f, f), floor, tolerance);
  };
  const auto look_at_pair = [&](DifferentBends& bends, std::uint32_t h, std::uint32_t k) {
    const FaceId f = adjacency.face_of(h), g = adjacency.face_of(k);
    if (f == g || !is_witness(f) || !is_witness(g)) return;
    // The test does not depend on orientation: the faces must be on opposite sides of the edge, and not on each other.
    const double cosine = dot(geometry[f].normal, geometry[g].normal);
    if (!((adjacency.from(h) == adjacency.from(k) ? -cosine : cosine) > 0)) return;
    // Rounding a corner moves it off the other face's plane by the rounding itself. But the same rounding tilts a small
    // face so much that corners of a large face are farther off the small face's plane. So the smaller distance counts.
    bends.add(std::min(bend(f, g), bend(g, f)), floor, tolerance);
  };
  const auto look_at_edge = [&](DifferentBends& bends, EdgeId e) {
    const auto around = adjacency.half_edges(e);
    if (around.size() > kMaxAround) return;
    for (std::size_t i = 1; i < around.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) look_at_pair(bends, around[i], around[j]);
  };
  DifferentBends all;
  const auto look_at_all = [&](std::size_t count, const auto& look_at) {
    // The other blocks do not matter as soon as one block has enough bends.
    std::atomic<bool> is_over = all.count() >= amounts;
    const auto blocks = map_blocks<DifferentBends>(count, kNoiseBlock, control, [&](std::size_t i, std::size_t end) {
      DifferentBends bends;
      for (; i < end && !is_over; ++i) {
        control.check();  // large polygons take a while
        look_at(bends, i);
        if (bends.count() >= amounts) is_over = true;
      }
      return bends;
    });
    for (const DifferentBends& bends : blocks) all.add(bends);
  };
  look_at_all(adjacency.edge_count(), [&](DifferentBends& bends, std::size_t i) { look_at_edge(bends, EdgeId(i)); });
  if (!adjacency.are_triangles())
    look_at_all(surface.face_count(), [&](DifferentBends& bends, std::size_t i) { look_at_polygon(bends, FaceId(i)); });
  return all.count() >= amounts;
}

}  // namespace remesh
