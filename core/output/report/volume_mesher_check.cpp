#include "core/output/report/volume_mesher_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"
#include "core/geometry/exact/predicates_3d.h"
#include "core/geometry/shells/inside_out.h"
#include "core/geometry/triangles/overlap.h"
#include "core/solids/solid_union.h"

namespace remesh {
namespace {

/// If an edge has more faces than this, only faces next to each other in their order around it are tested for small
/// angles. In exact order this would find all small angles, but the order is by rounded angles.
constexpr std::size_t kFewAround = 8;

/// The obstacles, by kind.
struct Obstacles {
  VolumeObstacle open{DiagnosticCode::kOpenBoundary, 0, {}}, non_manifold{DiagnosticCode::kNonManifoldEdge, 0, {}},
      winding{DiagnosticCode::kInconsistentWinding, 0, {}}, duplicate{DiagnosticCode::kDuplicateFace, 0, {}},
      crossing{DiagnosticCode::kSelfIntersection, 0, {}}, overlap{DiagnosticCode::kOverlappingFaces, 0, {}},
      dihedral{DiagnosticCode::kSmallDihedral, 0, {}}, inside_out{DiagnosticCode::kInsideOut, 0, {}};
  std::vector<EdgeId> crowded;  ///< edges with more than two faces

  std::array<VolumeObstacle*, 8> all() {
    return {&open, &non_manifold, &winding, &duplicate, &crossing, &overlap, &dihedral, &inside_out};
  }
};

Vec3 centroid(const Triangle& t, std::span<const Vec3> positions) {
  const auto third = [&](int i) { return (1.0 / 3) * positions[t[i].value]; };
  return third(0) + third(1) + third(2);
}

/// Examines edges, one after the other.
class EdgeExamination {
 public:
  EdgeExamination(std::span<const Vec3> positions, const Adjacency& edges, RunControl& control)
      : positions_(positions), edges_(edges), control_(control), check_(control) {}

  Obstacles run(std::size_t begin, std::size_t end) {
    for (std::size_t e = begin; e < end; ++e) examine(EdgeId(e));
    return std::move(found_);
  }

 private:
  void examine(EdgeId e) {
    const auto around = edges_.half_edges(e);
    const VertexId from = edges_.from(around[0]), to = edges_.to(around[0]);
    if (from == to) return;
    const Vec3 middle = 0.5 * positions_[from.value] + 0.5 * positions_[to.value];
    if (around.size() == 1) found_.open.add(middle);
    if (around.size() > 2) found_.crowded.push_back(e);
    if (around.size() == 2 && edges_.twin(around[0]) == kNone) found_.winding.add(middle);
    if (around.size() > 1 && has_small_angle(around)) found_.dihedral.add(middle);
    if (around.size() > 1) count_duplicates(around);
  }

  VertexId apex(std::uint32_t h) const { return edges_.from(edges_.next(edges_.next(h))); }

  /// Returns whether two faces meet at more than a right angle. It computes no root. If numbers overflow, the answer is
  /// no.
  bool are_wide_apart(std::uint32_t h, std::uint32_t g) const {
    const Vec3 from = positions_[edges_.from(h).value], axis = positions_[edges_.to(h).value] - from;
    const double squared = norm_squared(axis);
    const auto arm = [&](std::uint32_t half_edge) {
      const Vec3 to = positions_[apex(half_edge).value] - from;
      return squared * to - dot(to, axis) * axis;
    };
    const double product = dot(arm(h), arm(g));
    return product < 0 && std::isfinite(product);
  }

  bool has_small_angle(std::span<const std::uint32_t> around) {
    // This is so at most edges.
    if (around.size() == 2 && are_wide_apart(around[0], around[1])) return false;
    const Vec3 a = positions_[edges_.from(around[0]).value], b = positions_[edges_.to(around[0]).value];
    const Vec3 axis = normalized(b - a);
    // Unit vectors from the edge into each face, at right angles to the edge. Faces without area have none.
    arms_.clear();
    for (const std::uint32_t h : around) {
      check_();
      const Vec3 to = normalized(positions_[apex(h).value] - a);
      const Vec3 arm = normalized(to - dot(to, axis) * axis);
      if (arm != Vec3{}) arms_.push_back({arm, 0, apex(h)});
    }
    if (arms_.size() < 2) return false;
    const auto is_small = [](const Arm& p, const Arm& q) {
      constexpr double kTangent = kSmallDihedralDeg * std::numbers::pi / 180;
      const double cosine = dot(p.arm, q.arm);
      return p.apex != q.apex && cosine > 0 && norm(cross(p.arm, q.arm)) < kTangent * cosine;
    };
    if (arms_.size() <= kFewAround) {
      for (std::size_t i = 0; i < arms_.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
          if (is_small(arms_[i], arms_[j])) return true;
      return false;
    }
    const Vec3 x = arms_[0].arm, y = cross(axis, x);
    for (Arm& arm : arms_) {
      check_();
      arm.angle = std::atan2(dot(arm.arm, y), dot(arm.arm, x));
    }
    sort_stoppable(arms_.begin(), arms_.end(), control_,
                   [](const Arm& p, const Arm& q) { return p.angle != q.angle ? p.angle < q.angle : p.apex < q.apex; });
    for (std::size_t i = 0; i < arms_.size(); ++i)
      if (is_small(arms_[i], arms_[(i + 1) % arms_.size()])) return true;
    return false;
  }

  /// Counts faces over the same three vertices. They are found at the edge between the two smallest of these.
  void count_duplicates(std::span<const std::uint32_t> around) {
    apexes_.clear();
    for (const std::uint32_t h : around)
      if (const VertexId v = apex(h); v > edges_.from(h) && v > edges_.to(h)) apexes_.push_back(v);
    sort_stoppable(apexes_.begin(), apexes_.end(), control_);
    for (std::size_t i = 1; i < apexes_.size(); ++i)
      if (apexes_[i] == apexes_[i - 1])
        found_.duplicate.add(centroid({edges_.from(around[0]), edges_.to(around[0]), apexes_[i]}, positions_));
  }

  struct Arm {
    Vec3 arm;
    double angle;
    VertexId apex;
  };

  std::span<const Vec3> positions_;
  const Adjacency& edges_;
  RunControl& control_;
  StopCheck check_;
  Obstacles found_;
  std::vector<Arm> arms_;
  std::vector<VertexId> apexes_;
};

class Examination {
 public:
  Examination(std::span<const Vec3> positions, std::span<const VertexId> corners, const Adjacency& edges,
              const BodyLabels& labels, RunControl& control)
      : positions_(positions), corners_(corners), edges_(edges), labels_(labels), control_(control) {}

  std::vector<VolumeObstacle> run(std::span<const std::pair<FaceId, FaceId>> intersections, double plane_tolerance) {
    examine_edges();
    examine_pairs(intersections, plane_tolerance);
    examine_crowded_edges(!intersections.empty() || found_.duplicate.count > 0);
    examine_shells();
    std::vector<VolumeObstacle> found;
    for (VolumeObstacle* o : found_.all())
      if (o->count > 0) found.push_back(std::move(*o));
    return found;
  }

 private:
  void examine_edges() {
    auto found =
        map_blocks<Obstacles>(edges_.edge_count(), kItemsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
          return EdgeExamination(positions_, edges_, control_).run(begin, end);
        });
    for (Obstacles& of_block : found) {
      for (std::size_t kind = 0; kind < of_block.all().size(); ++kind) found_.all()[kind]->add(*of_block.all()[kind]);
      found_.crowded.insert(found_.crowded.end(), of_block.crowded.begin(), of_block.crowded.end());
    }
  }

  /// Adds the edges with more than two faces at which some face has the same cell on both sides: there a sheet ends, or
  /// does not close anything. All other faces there bound cells that are closed, and meshers fill these.
  void examine_crowded_edges(bool do_faces_meet) {
    if (found_.crowded.empty()) return;
    if (!do_faces_meet) find_cells_of_edges();
    const auto bounds_nothing = [&](std::uint32_t h) {
      const std::size_t f = h / 3;
      return cells_.of_side[2 * f] == cells_.of_side[2 * f + 1];
    };
    StopCheck check(control_);
    for (const EdgeId e : found_.crowded) {
      check();
      const auto around = edges_.half_edges(e);
      if (!do_faces_meet && std::none_of(around.begin(), around.end(), bounds_nothing)) continue;
      found_.non_manifold.add(0.5 * positions_[edges_.from(around[0]).value] +
                              0.5 * positions_[edges_.to(around[0]).value]);
    }
  }

  void find_cells_of_edges() {
    const std::vector<Vec3> scaled = scaled_for_predicates(positions_, control_);
    std::vector<Triangle> faces;
    for (FaceId f(0); f.value < corners_.size() / 3; ++f.value) faces.push_back(face(f));
    const std::vector<std::int32_t> weights(faces.size(), 0);
    cells_ = find_cells({scaled, faces, weights}, control_);
    volumes_.assign(cells_.winding.size(), 0);
    StopCheck check(control_);
    for (std::size_t f = 0; f < faces.size(); ++f) {
      check();
      const Vec3 &a = scaled[faces[f][0].value], &b = scaled[faces[f][1].value], &c = scaled[faces[f][2].value];
      const Vec3& origin = scaled[faces.front()[0].value];
      const double volume = dot(a - origin, cross(b - a, c - a));
      volumes_[cells_.of_side[2 * f]] -= volume;
      volumes_[cells_.of_side[2 * f + 1]] += volume;
    }
  }

  /// Returns whether there is a closed cell on both sides of a face. Such a face is a wall and may face either way.
  bool is_between_cells(FaceId f) const {
    return !volumes_.empty() && volumes_[cells_.of_side[2 * std::size_t{f.value}]] > 0 &&
           volumes_[cells_.of_side[2 * std::size_t{f.value} + 1]] > 0;
  }

  Triangle face(FaceId f) const {
    const std::size_t h = 3 * std::size_t{f.value};
    return {corners_[h], corners_[h + 1], corners_[h + 2]};
  }

  void examine_pairs(std::span<const std::pair<FaceId, FaceId>> pairs, double tolerance) {
    StopCheck check(control_);
    for (const auto& [f, g] : pairs) {
      check();
      Triangle a = face(f), b = face(g);
      std::sort(a.begin(), a.end());
      std::sort(b.begin(), b.end());
      if (a == b) continue;
      (do_overlap(a, b, positions_, tolerance) ? found_.overlap : found_.crossing).add(meeting_place(a, b, positions_));
    }
  }

  void examine_shells() {
    const std::vector<Vec3> scaled = scaled_for_predicates(positions_, control_);
    for (const FaceId f : find_inside_out(scaled, corners_, edges_, labels_, control_).first_faces)
      if (!is_between_cells(f)) found_.inside_out.add(centroid(face(f), positions_));
  }

  std::span<const Vec3> positions_;
  std::span<const VertexId> corners_;
  const Adjacency& edges_;
  const BodyLabels& labels_;
  RunControl& control_;
  Obstacles found_;
  Cells cells_;                  ///< empty unless edges have more than two faces, and no faces intersect
  std::vector<double> volumes_;  ///< of the cells, up to a factor; those outside of parts are not positive
};

}  // namespace

std::vector<VolumeObstacle> find_volume_obstacles(std::span<const Vec3> positions, std::span<const VertexId> corners,
                                                  const Adjacency& edges, const BodyLabels& labels,
                                                  std::span<const std::pair<FaceId, FaceId>> intersections,
                                                  double plane_tolerance, RunControl& control) {
  return Examination(positions, corners, edges, labels, control).run(intersections, plane_tolerance);
}

void add_incomplete_check(double searched, std::size_t faces, std::vector<VolumeObstacle>& obstacles) {
  if (searched >= 1) return;
  const auto left = static_cast<std::uint64_t>((1 - searched) * static_cast<double>(faces));
  obstacles.push_back({DiagnosticCode::kIncompleteCheck, std::max<std::uint64_t>(left, 1), {}});
}

}  // namespace remesh
