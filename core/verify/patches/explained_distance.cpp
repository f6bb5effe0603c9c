#include "core/verify/patches/explained_distance.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "core/base/stoppable.h"

namespace remesh::verification {
namespace {

/// Faces whose corners are within this many tolerances of a plane are one facet.
constexpr double kFlat = 2;
/// If a facet turns on one side by less than this part of its turn on the other side, the smaller one counts as no
/// turn.
constexpr double kNoTurn = 0.2;
/// A corner has no meaningful normal if its distance from the axis is below this part of the farthest corner's.
constexpr double kNearAxis = 0.02;
/// The measures of a facet are accurate up to this factor and this number of tolerances.
constexpr double kSlack = 1.05, kSlackInTolerances = 4;

/// A set of faces in one plane.
struct FlatPiece {
  std::vector<std::uint32_t> faces;
  std::vector<Vec3> corners;
  Vec3 normal, middle;
};

class Explained {
 public:
  Explained(const NumberedClaim& numbered, const EdgeTable& edges, PatchId patch, double max_turn, RunControl& control)
      : numbered_(numbered),
        edges_(edges),
        shape_(numbered.curved_surface(patch)->shape),
        faces_(numbered.input_by_patch[patch.value]),
        min_cosine_(std::cos(max_turn)),
        is_taken_(faces_.size(), 0),
        check_(control) {}

  bool explains(double distance) {
    std::vector<std::pair<double, std::uint32_t>> from_large;
    for (const std::uint32_t f : faces_) {
      check_();
      from_large.push_back({-norm(area_vector(f)), f});
    }
    std::sort(from_large.begin(), from_large.end());
    for (const auto& [area, f] : from_large) {
      if (area == 0 || is_taken_[place_of(f)] != 0) continue;
      if (kSlack * explained(facet_of(f)) + kSlackInTolerances * numbered_.tolerance >= distance) return true;
    }
    return false;
  }

 private:
  /// Returns the place of a face among those of the patch, or their number if it is not one of them.
  std::size_t place_of(std::uint32_t face) const {
    const auto at = std::lower_bound(faces_.begin(), faces_.end(), face);
    return at != faces_.end() && *at == face ? static_cast<std::size_t>(at - faces_.begin()) : faces_.size();
  }

  Vec3 area_vector(std::uint32_t face) const {
    const auto corners = numbered_.input.face(face);
    const Vec3 first = numbered_.points[corners[0].value];
    Vec3 twice;
    for (std::size_t i = 2; i < corners.size(); ++i)
      twice += cross(numbered_.points[corners[i - 1].value] - first, numbered_.points[corners[i].value] - first);
    return twice;
  }

  /// Calls visit(face) for each face beyond an edge that has one other face.
  template <class Visit>
  void for_each_beyond(std::uint32_t face, const Visit& visit) {
    const auto corners = numbered_.input.face(face);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      check_();
      const std::vector<Use> uses = edges_.find(corners[i], corners[i + 1 == corners.size() ? 0 : i + 1]);
      if (uses.size() != 2) continue;
      for (const Use& use : uses) {
        const auto begin = numbered_.input.face_begin;
        const auto next = std::upper_bound(begin.begin(), begin.end(), use.half_edge);
        const auto other = static_cast<std::uint32_t>(next - begin.begin() - 1);
        if (other != face) visit(other);
      }
    }
  }

  /// Collects the faces around a face that lie in its plane.
  FlatPiece facet_of(std::uint32_t first) {
    FlatPiece facet;
    facet.faces.push_back(first);
    is_taken_[place_of(first)] = 1;
    facet.normal = normalized(area_vector(first));
    const Vec3 origin = numbered_.points[numbered_.input.face(first)[0].value];
    for (std::size_t k = 0; k < facet.faces.size(); ++k)
      for_each_beyond(facet.faces[k], [&](std::uint32_t f) {
        const std::size_t place = place_of(f);
        if (place == faces_.size() || is_taken_[place] != 0) return;
        if (!(dot(area_vector(f), facet.normal) > 0)) return;
        for (const VertexId v : numbered_.input.face(f))
          if (!(std::fabs(dot(numbered_.points[v.value] - origin, facet.normal)) <= kFlat * numbered_.tolerance))
            return;
        is_taken_[place] = 1;
        facet.faces.push_back(f);
      });
    Vec3 twice;
    for (const std::uint32_t f : facet.faces) {
      twice += area_vector(f);
      for (const VertexId v : numbered_.input.face(f)) facet.corners.push_back(numbered_.points[v.value]);
    }
    facet.normal = normalized(twice);
    for (const Vec3& p : facet.corners) facet.middle += (1 / static_cast<double>(facet.corners.size())) * p;
    return facet;
  }

  /// Returns the normals of the faces around a facet that turn against it. Faces that share only a corner with a
  /// triangle count, too: the other halves of the pieces of a surface lie between the triangle and the next piece.
  std::vector<Vec3> normals_around(const FlatPiece& facet) {
    std::vector<Vec3> normals;
    const auto add = [&](std::uint32_t f) {
      const Vec3 normal = normalized(area_vector(f));
      if (norm_squared(normal) > 0 && dot(normal, facet.normal) >= min_cosine_ && leaves_plane(f, facet))
        normals.push_back(normal);
    };
    const auto is_own = [&](std::uint32_t f) {
      return std::find(facet.faces.begin(), facet.faces.end(), f) != facet.faces.end();
    };
    const bool is_triangle = facet.faces.size() == 1 && facet.corners.size() == 3;
    for (const std::uint32_t f : facet.faces)
      for_each_beyond(f, [&](std::uint32_t g) {
        if (facet.faces.size() < kManyFaces && is_own(g)) return;
        add(g);
        if (!is_triangle || !(dot(normalized(area_vector(g)), facet.normal) >= min_cosine_)) return;
        const auto own = numbered_.input.face(f);
        for_each_beyond(g, [&](std::uint32_t h) {
          const auto corners = numbered_.input.face(h);
          if (h != f && std::find_first_of(own.begin(), own.end(), corners.begin(), corners.end()) != own.end()) add(h);
        });
      });
    return normals;
  }

  /// Returns whether a face turns against a facet by more than noise explains.
  bool leaves_plane(std::uint32_t face, const FlatPiece& facet) const {
    const auto corners = numbered_.input.face(face);
    return std::any_of(corners.begin(), corners.end(), [&](VertexId v) {
      return std::fabs(dot(numbered_.points[v.value] - facet.middle, facet.normal)) > kFlat * numbered_.tolerance;
    });
  }

  double distance_from_axis(const Vec3& p) const { return shape_.is_ruled() ? shape_.ruled(p).radius : HUGE_VAL; }

  double explained(const FlatPiece& facet) {
    const std::vector<Vec3> around = normals_around(facet);
    const Vec3 normal = shape_.normal(facet.middle);
    // The direction around the axis. On a sphere, the direction in which the facet turns most against a neighbour.
    Vec3 direction = shape_.direction_around(facet.middle);
    if (norm_squared(direction) == 0)
      for (const Vec3& n : around) {
        const Vec3 turn = n - dot(n, facet.normal) * facet.normal;
        if (norm_squared(turn) > norm_squared(direction)) direction = turn;
      }
    direction = normalized(direction);
    double height = height_along(facet, around, direction);
    if (!shape_.is_ruled()) height += height_along(facet, around, normalized(cross(normal, direction)));
    return height;
  }

  double height_along(const FlatPiece& facet, std::span<const Vec3> around, const Vec3& direction) const {
    double farthest = 0;
    for (const Vec3& p : facet.corners) farthest = std::max(farthest, distance_from_axis(p));
    Range width, turn;
    for (const Vec3& p : facet.corners) {
      width.add(dot(p, direction));
      if (shape_.is_ruled() && !(distance_from_axis(p) > kNearAxis * farthest)) continue;
      turn.add(std::asin(std::clamp(dot(shape_.normal(p), direction), -1.0, 1.0)));
    }
    double before = 0, behind = 0;
    for (const Vec3& n : around) {
      const double angle = std::asin(std::clamp(dot(n - facet.normal, direction), -1.0, 1.0));
      before = std::max(before, angle);
      behind = std::max(behind, -angle);
    }
    const double larger = std::max(before, behind);
    const double allowed = std::min(before, behind) > kNoTurn * larger ? before + behind : 2 * larger;
    const double span = turn.high - turn.low;
    if (!(span > 0) || !(allowed > 0)) return 0;
    const double radius = (width.high - width.low) / (2 * std::sin(span / 2));
    return radius * (1 - std::cos(std::min(span, allowed) / 2));
  }

  static constexpr std::size_t kManyFaces = 64;

  const NumberedClaim& numbered_;
  const EdgeTable& edges_;
  const CurvedShape& shape_;
  std::span<const std::uint32_t> faces_;  ///< of the patch, ascending
  double min_cosine_;
  std::vector<std::uint8_t> is_taken_;  ///< one per face of the patch: it belongs to a facet already
  StopCheck check_;
};

}  // namespace

bool explains_distance(const NumberedClaim& numbered, const EdgeTable& input_edges, PatchId patch, double max_turn,
                       double distance, RunControl& control) {
  return Explained(numbered, input_edges, patch, max_turn, control).explains(distance);
}

}  // namespace remesh::verification
