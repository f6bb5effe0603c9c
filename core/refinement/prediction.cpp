#include "core/refinement/prediction.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/blocks.h"
#include "core/stages/projection.h"

namespace remesh {
namespace {

/// Faces of a refined area, per equilateral face of the size asked for. Measured on cubes and plates.
constexpr double kFacesPerIdeal = 1.45;

/// Flat triangles are not filled further than floors allow.
constexpr double kMostOfFlat = 64;

/// Area of the equilateral triangle with that edge.
double ideal_area(double edge) { return std::numbers::sqrt3 / 4 * edge * edge; }

class PatchPrediction {
 public:
  PatchPrediction(const PatchMesh& patch, const Goals& goals, const SizeField& sizes)
      : patch_(patch), goals_(goals), sizes_(sizes) {}

  Prediction run() const {
    const Triangulation2d& mesh = patch_.mesh;
    const double scale = patch_.frame.scale;
    const double largest = std::min(goals_.max_area, ideal_area(sizes_.largest()));
    double pieces = 0, area = 0, by_angle = 0, by_size = 0;
    for (std::uint32_t h = 0; h < mesh.half_edge_count(); h += 3) {
      const Vec2 p[3] = {patch_.uv[mesh.from(h)], patch_.uv[mesh.from(h + 1)], patch_.uv[mesh.from(h + 2)]};
      double length[3];
      for (std::uint32_t k = 0; k < 3; ++k) {
        const Vec2 side = p[(k + 1) % 3] - p[k];
        length[k] = std::sqrt(dot(side, side)) * scale;
        if (mesh.is_constrained(h + k) && goals_.split_boundaries)
          pieces += std::max(1.0, std::ceil(length[k] / sizes_.largest() * (1 - 1e-12)));
      }
      const double triangle = cross(p[1] - p[0], p[2] - p[0]) / 2 * scale * scale;
      area += triangle;
      by_angle += faces_for_angle(length, triangle);
      by_size += faces_for_size(p, triangle);
    }
    Prediction result;
    result.least = std::max({static_cast<double>(mesh.triangle_count()), pieces - 2, area / largest});
    result.expected = std::max({result.least, by_angle, by_size});
    return result;
  }

 private:
  /// A triangle with a small angle is filled with others that grow from its short edge; if it is flat, all along it.
  double faces_for_angle(const double (&length)[3], double area) const {
    const double longest = std::max({length[0], length[1], length[2]});
    const double shortest = std::min({length[0], length[1], length[2]});
    const double height = 2 * area / longest;
    if (!(height > 0) || goals_.min_angle_deg == 0) return 1;
    const double tangent = std::tan(goals_.min_angle_deg * std::numbers::pi / 180);
    // The smallest angle's height over its reach.
    const double sharpness = tangent / (2 * area / (longest * longest));
    if (sharpness <= 1) return 1;
    return 1 + 2 * std::log2(sharpness) + (shortest > 2 * height ? std::min(shortest / height, kMostOfFlat) : 0);
  }

  double faces_for_size(const Vec2 (&p)[3], double area) const {
    const double edge = std::min(sizes_.largest(), std::sqrt(goals_.max_area * 4 / std::numbers::sqrt3));
    if (sizes_.is_uniform()) return std::isfinite(edge) ? kFacesPerIdeal * area / ideal_area(edge) : 0;
    // Sizes are read in the middles of small triangles of it.
    constexpr int kParts = 6;
    const double part = area / (kParts * kParts);
    double faces = 0;
    for (int i = 0; i < kParts; ++i)
      for (int j = 0; i + j < kParts; ++j)
        for (int up = 0; up < (i + j + 1 < kParts ? 2 : 1); ++up) {
          const double u = (i + (1.0 + up) / 3) / kParts, v = (j + (1.0 + up) / 3) / kParts;
          const Vec2 at = p[0] + u * (p[1] - p[0]) + v * (p[2] - p[0]);
          const double size = std::min(edge, sizes_.at(to_space(patch_.frame, at)));
          if (std::isfinite(size)) faces += kFacesPerIdeal * part / ideal_area(size);
        }
    return faces;
  }

  const PatchMesh& patch_;
  const Goals& goals_;
  const SizeField& sizes_;
};

}  // namespace

Prediction predict(const std::vector<PatchMesh>& meshes, const Goals& goals, const SizeField& sizes,
                   RunControl& control) {
  const auto blocks = map_blocks<Prediction>(meshes.size(), 64, control, [&](std::size_t begin, std::size_t end) {
    Prediction sum;
    for (std::size_t p = begin; p < end; ++p) {
      const Prediction one = PatchPrediction(meshes[p], goals, sizes).run();
      sum.least += one.least;
      sum.expected += one.expected;
    }
    return sum;
  });
  Prediction total;
  for (const Prediction& block : blocks) {
    total.least += block.least;
    total.expected += block.expected;
  }
  return total;
}

}  // namespace remesh
