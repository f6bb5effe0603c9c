#include "core/output/run/proven_coarsening.h"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "core/base/stoppable.h"
#include "core/geometry/intersections/self_intersections.h"
#include "core/mesh/mesh.h"
#include "core/mesh/quality.h"
#include "core/verify/near_faces/near_faces.h"

namespace remesh {
namespace {

/// Samples miss a part of the distance, so the surface is made within the first share of the tolerance, and in each
/// further round within that share of the last one; after three rounds, within the second share. Where the surface is
/// made anew, other places may be at fault: on noisy terrain, two or three of them in each round.
constexpr double kShareForSamples = 0.95, kShareAfterThree = 0.9;
/// Where a proof fails, the share of the tolerance that counts is multiplied by this.
constexpr float kAfterDistance = 0.8F, kAfterIntersection = 0.3F;
/// The number of rings of faces around a face at fault that get the smaller share as well.
constexpr int kRingsAround = 2;

/// The facts about a surface that must not change.
struct Topology {
  Topology(const IdVector<VertexId, Vec3>& positions, const IdVector<FaceId, Triangle>& faces, RunControl& control) {
    const MeshStatistics measured = measure_surface(TriangleMesh{positions, faces, {}}, control);
    euler = measured.euler;
    components = measured.components;
    is_closed = measured.closed;
  }
  bool operator==(const Topology&) const = default;

  std::int64_t euler = 0;
  std::uint64_t components = 0;
  bool is_closed = false;
};

/// The shares of the tolerance that count at the faces of the input.
class FaceShares {
 public:
  explicit FaceShares(const FreeForm& input) : input_(input) {
    if (input.shares.empty())
      shares_.assign(input.faces.size(), 1);
    else
      shares_.assign(input.shares.begin(), input.shares.end());
  }

  std::span<const float> all() const { return shares_; }
  void lower_all(float factor) {
    for (float& share : shares_) share *= factor;
  }
  /// Lowers the shares of faces, and of the faces around them.
  void lower(const std::vector<FaceId>& faces, float factor, RunControl& control) {
    std::vector<std::uint8_t> is_face(input_.faces.size(), 0), is_vertex(input_.positions.size(), 0);
    for (const FaceId f : faces) is_face[f.value] = 1;
    StopCheck check(control);
    for (int ring = 0; ring < kRingsAround; ++ring) {
      for (FaceId f(0); f.value < is_face.size(); ++f.value) {
        check();
        if (is_face[f.value] == 0) continue;
        for (const VertexId v : input_.faces[f]) is_vertex[v.value] = 1;
      }
      for (FaceId f(0); f.value < is_face.size(); ++f.value) {
        check();
        for (const VertexId v : input_.faces[f]) is_face[f.value] |= is_vertex[v.value];
      }
    }
    for (std::size_t f = 0; f < is_face.size(); ++f)
      if (is_face[f] != 0) shares_[f] *= factor;
  }

 private:
  const FreeForm& input_;
  std::vector<float> shares_;
};

/// Lowers the shares of the tolerance where faces meet.
/// Output: whether none do.
bool are_no_faces_crossing(const Coarsened& made, FaceShares& shares, RunControl& control) {
  const SearchLimits limits(SearchLimits::kEnoughPairs, SearchLimits::steps_for(made.faces.size()));
  const SelfIntersections found = self_intersections(made.positions.items(), made.faces.items(), {}, limits, control);
  if (found.pairs.empty()) return found.is_complete;
  IdVector<FaceId, std::uint8_t> is_crossing(made.faces.size(), 0);
  for (const auto& [f, g] : found.pairs) is_crossing[f] = is_crossing[g] = 1;
  // All that such a face answers for is at fault, because it is not known where in the face the fault is.
  std::vector<FaceId> at_fault;
  for (FaceId f(0); f.value < made.answers.size(); ++f.value)
    if (made.answers[f].is_valid() && is_crossing[made.answers[f]] != 0) at_fault.push_back(f);
  shares.lower(at_fault, kAfterIntersection, control);
  return false;
}

/// Lowers the shares of the tolerance where the surfaces are too far apart. All are lowered if there are more such
/// places than are known.
void lower_where_far(const verification::TwoWayDistance& measured, const Coarsened& made, FaceShares& shares,
                     RunControl& control) {
  std::vector<FaceId> far;
  for (const verification::FarFace& face : measured.a_to_b.far_faces) far.push_back(face.face);
  for (const verification::FarFace& face : measured.b_to_a.far_faces) far.push_back(made.nearest[face.face]);
  const bool are_all_known = measured.a_to_b.far_count <= measured.a_to_b.far_faces.size() &&
                             measured.b_to_a.far_count <= measured.b_to_a.far_faces.size();
  if (are_all_known)
    shares.lower(far, kAfterDistance, control);
  else
    shares.lower_all(kAfterDistance);
}

}  // namespace

std::optional<ProvenCoarsening> coarsen_with_proof(const FreeForm& input, const CoarseningGoals& goals,
                                                   CoarseningFault& fault, RunControl& control) {
  const Topology before(input.positions, input.faces, control);
  FaceShares shares(input);
  double tolerance = goals.tolerance;
  for (int round = 1; round <= kMaxCoarseningRounds; ++round) {
    tolerance *= round <= 3 ? kShareForSamples : kShareAfterThree;
    FreeForm form = input;
    form.shares = shares.all();
    Coarsened made = coarsen(form, {tolerance, goals.min_angle_deg}, control);
    fault = CoarseningFault::kTopology;
    if (Topology(made.positions, made.faces, control) != before) return std::nullopt;
    const verification::TwoWayDistance measured =
        verification::distance_between({input.positions.items(), input.faces.items()},
                                       {made.positions.items(), made.faces.items()}, goals.tolerance, control);
    const double distance = std::max(measured.a_to_b.bound, measured.b_to_a.bound);
    fault = CoarseningFault::kDistance;
    if (!(distance <= goals.tolerance)) {
      lower_where_far(measured, made, shares, control);
      continue;
    }
    fault = CoarseningFault::kIntersections;
    if (!are_no_faces_crossing(made, shares, control)) continue;
    fault = CoarseningFault::kNone;
    return ProvenCoarsening{std::move(made), distance, round};
  }
  return std::nullopt;
}

}  // namespace remesh
