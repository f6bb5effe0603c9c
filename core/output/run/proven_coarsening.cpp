#include "core/output/run/proven_coarsening.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"
#include "core/geometry/intersections/self_intersections.h"
#include "core/geometry/trees/box_tree.h"
#include "core/geometry/trees/triangle_tree.h"
#include "core/geometry/triangles/distances.h"
#include "core/mesh/mesh.h"
#include "core/mesh/quality.h"
#include "core/output/run/coarsening_proof.h"

namespace remesh {
namespace {

/// Samples miss a part of the distance, so the surface is made within the first share of the tolerance. If more than
/// this share of its faces are at fault or any of them meet, and for all later surfaces, the second share counts.
constexpr double kShareForSamples = 0.95, kShareAfterFaults = 0.8, kManyFaults = 0.01;
/// A refinement helps if it leaves at most this share of the faults. A surface is given up after so many that do not.
constexpr double kFewer = 0.7;
constexpr int kVainRefinements = 2;
/// When the surface is made anew, the share of the tolerance that counts where a proof has failed is multiplied by
/// this.
constexpr float kAfterDistance = 0.8F, kAfterIntersection = 0.3F;
/// After this many surfaces, faces stay where a proof has failed.
constexpr int kSurfacesWithoutKeeping = 2;
/// The first surfaces get their volume back, if that is asked for.
constexpr int kSurfacesWithVolume = 4;
/// Faces face each other if the cosine of the angle between their normals is below this.
constexpr double kFacing = -0.2;
/// The share of the gap between such faces that each of them may use.
constexpr double kShareOfGap = 0.4;
constexpr float kMinShare = 0.01F;
/// The search for the gap at a face ends after this number of boxes. Where a gap is not found, the proof may fail, and
/// the coarser surface is refined there.
constexpr int kMaxBoxes = 4096;
/// The number of rings of faces around a face at fault that get the smaller share as well.
constexpr int kRingsAround = 2;

/// The normals of the faces in a box. Around a face, most boxes have normals that are much the same.
struct Directions {
  FloatBox box;
  void join(const Directions& other) { box.add(other.box); }
  /// Returns a bound on the cosine between a unit vector and the normals.
  double least_cosine(const Vec3& v) const {
    double sum = 0;
    for (int axis = 0; axis < 3; ++axis) sum += std::min(v[axis] * box.min[axis], v[axis] * box.max[axis]);
    return sum;
  }
};

/// The shares of the tolerance that count at the faces of the input, and the vertices that stay.
class FaceShares {
 public:
  explicit FaceShares(const FreeForm& input)
      : input_(input),
        shares_(input.shares.begin(), input.shares.end()),
        is_held_(input.is_held.begin(), input.is_held.end()) {
    if (shares_.empty()) shares_.assign(input.faces.size(), 1);
    if (is_held_.empty()) is_held_.assign(input.positions.size(), 0);
  }

  FreeForm form() const {
    FreeForm form = input_;
    form.shares = shares_;
    form.is_held = is_held_;
    return form;
  }
  /// Lowers the shares of faces, and of the faces around them.
  void lower(const std::vector<FaceId>& faces, float factor, RunControl& control) {
    const std::vector<std::uint8_t> is_near = with_rings(faces, control);
    for (std::size_t f = 0; f < is_near.size(); ++f)
      if (is_near[f] != 0) shares_[f] *= factor;
  }
  /// Bounds the shares by the gaps between faces that face each other, so that these seldom meet.
  void limit_by_gaps(const FacesAround& around, double tolerance, RunControl& control) {
    const std::size_t n = shares_.size();
    const auto corners = [&](std::size_t i) -> Corners3 {
      if (i >= n) {
        const Triangle& t = around.faces[i - n];
        return {around.positions[t[0].value], around.positions[t[1].value], around.positions[t[2].value]};
      }
      const Triangle& t = input_.faces[FaceId(i)];
      return {input_.positions[t[0]], input_.positions[t[1]], input_.positions[t[2]]};
    };
    const auto vertices = [&](std::size_t i) -> Triangle {
      if (i >= n) return around.faces[i - n];
      const Triangle& t = input_.faces[FaceId(i)];
      return {around.of_vertex[t[0].value], around.of_vertex[t[1].value], around.of_vertex[t[2].value]};
    };
    const auto normal = [](const Corners3& c) { return normalized(cross(c[1] - c[0], c[2] - c[0])); };
    const std::size_t count = n + around.faces.size();
    control.memory().ask_for<BoxTree<Directions>::Entry>(3 * count);
    const auto entries = BoxTree<Directions>::make_entries(count, control, [&](std::size_t i, auto& entry) {
      const Corners3 triangle = corners(i);
      for (const Vec3& p : triangle) entry.box.add(p);
      entry.tag.box.add(normal(triangle));
    });
    const BoxTree<Directions> tree(entries, control);
    for_blocks(n, 64, control, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) {
        if (!input_.is_of_plane.empty() && input_.is_of_plane[f] != 0) continue;
        const Corners3 own = corners(f);
        const Triangle one = vertices(f);
        const Vec3 centre = (1.0 / 3) * (own[0] + own[1] + own[2]), up = normal(own);
        const double enough = tolerance * static_cast<double>(shares_[f]) / kShareOfGap;
        double squared = enough * enough;
        int boxes = 0;
        tree.search(
            squared,
            [&](const BoxTree<Directions>::Entry& entry) {
              return ++boxes > kMaxBoxes || entry.tag.least_cosine(up) > kFacing ? HUGE_VAL
                                                                                 : squared_distance(entry.box, centre);
            },
            [&](std::size_t slot) {
              const Triangle other = vertices(tree.number(slot));
              if (std::find_first_of(one.begin(), one.end(), other.begin(), other.end()) != one.end()) return;
              const Vec3 near = nearest_on_triangle(centre, corners(tree.number(slot)));
              squared = std::min(squared, norm_squared(near - centre));
            });
        // A share has to be positive.
        const auto share = static_cast<float>(kShareOfGap * std::sqrt(squared) / tolerance);
        shares_[f] = std::min(shares_[f], std::max(share, kMinShare));
      }
    });
  }
  /// Keeps faces as they are, and those around them.
  void keep(const std::vector<FaceId>& faces, RunControl& control) {
    const std::vector<std::uint8_t> is_near = with_rings(faces, control);
    for (FaceId f(0); f.value < is_near.size(); ++f.value) {
      if (is_near[f.value] == 0) continue;
      for (const VertexId v : input_.faces[f]) is_held_[v.value] = 1;
    }
  }

 private:
  std::vector<std::uint8_t> with_rings(const std::vector<FaceId>& faces, RunControl& control) const {
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
    return is_face;
  }

  const FreeForm& input_;
  std::vector<float> shares_;
  std::vector<std::uint8_t> is_held_;
};

/// Returns the input faces for which these faces answer: it is not known where in a face the fault is.
std::vector<FaceId> answered_by(const Coarsened& made, const std::vector<FaceId>& faces) {
  IdVector<FaceId, std::uint8_t> is_wanted(made.faces.size(), 0);
  for (const FaceId f : faces) is_wanted[f] = 1;
  std::vector<FaceId> answered;
  for (FaceId f(0); f.value < made.answers.size(); ++f.value)
    if (made.answers[f].is_valid() && is_wanted[made.answers[f]] != 0) answered.push_back(f);
  for (const FaceId f : faces) answered.push_back(made.nearest[f]);
  return answered;
}

/// The faces of the input at which a surface could not be proven.
struct FaultyPlaces {
  FaultyPlaces(const CoarseningFaults& faults, const Coarsened& made)
      : far(faults.far_input_faces), crossing(answered_by(made, faults.crossing_faces)) {
    for (const FaceId f : faults.far_faces) far.push_back(made.nearest[f]);
  }
  std::vector<FaceId> far, crossing;
};

std::size_t count(const CoarseningFaults& faults) {
  return faults.far_faces.size() + faults.far_input_faces.size() + faults.crossing_faces.size();
}

}  // namespace

Topology::Topology(const TriangleMesh& mesh, RunControl& control) {
  const MeshStatistics measured = measure_surface(mesh, control);
  euler = measured.euler;
  components = measured.components;
  is_closed = measured.closed;
}

std::pair<std::vector<FaceId>, bool> crossing_faces(const FreeForm& input, const Coarsened& made,
                                                    std::span<const Vec3> places, const FacesAround& around,
                                                    RunControl& control) {
  // Vertices that stay are the same ones for the faces around.
  std::vector<Vec3> positions(around.positions.begin(), around.positions.end());
  IdVector<VertexId, VertexId> number;
  Box3 box;
  for (VertexId v(0); v.value < made.positions.size(); ++v.value) {
    box.add(places[v.value]);
    if (made.source[v].is_valid()) {
      number.push_back(around.of_vertex[made.source[v].value]);
    } else {
      number.push_back(VertexId(positions.size()));
      positions.push_back(places[v.value]);
    }
  }
  std::vector<Triangle> faces;
  faces.reserve(made.faces.size());
  for (const Triangle& t : made.faces) faces.push_back({number[t[0]], number[t[1]], number[t[2]]});
  StopCheck check(control);
  for (const Triangle& t : around.faces) {
    check();
    Box3 own;
    for (const VertexId v : t) own.add(positions[v.value]);
    if (do_meet(box, own)) faces.push_back(t);
  }
  const SearchLimits limits(SearchLimits::kEnoughPairs, SearchLimits::steps_for(faces.size()));
  const SelfIntersections found = self_intersections(positions, faces, {}, limits, control);
  const auto is_same = [&](FaceId f) {
    if (f.value >= made.faces.size()) return true;
    const Triangle& was = input.faces[made.origin[f]];
    return std::all_of(made.faces[f].begin(), made.faces[f].end(), [&](VertexId v) {
      return made.source[v].is_valid() && std::find(was.begin(), was.end(), made.source[v]) != was.end();
    });
  };
  std::vector<FaceId> crossing;
  for (const auto& [f, g] : found.pairs) {
    if (is_same(f) && is_same(g)) continue;
    for (const FaceId face : {f, g})
      if (face.value < made.faces.size()) crossing.push_back(face);
  }
  sort_unique(crossing);
  return {std::move(crossing), found.is_complete};
}

std::optional<ProvenCoarsening> coarsen_with_proof(const FreeForm& input, const FacesAround& around,
                                                   const CoarseningGoals& goals, const IsWanted& is_wanted,
                                                   const LastFaults& last_faults, CoarseningFault& fault,
                                                   RunControl& control) {
  const Topology before({input.positions, input.faces, {}}, control);
  FaceShares shares(input);
  // Where the tolerance is another one at each place, it is large on thin sheets that are flat.
  bool are_gaps_known = !input.shares.empty();
  if (are_gaps_known) shares.limit_by_gaps(around, goals.tolerance, control);
  double share = kShareForSamples;
  for (int made = 1; made <= kMaxCoarseSurfaces; ++made) {
    const bool is_volume_kept = goals.is_volume_kept && made <= kSurfacesWithVolume;
    CoarseSheet sheet(shares.form(), {goals.tolerance * share, goals.min_angle_deg, is_volume_kept}, control);
    fault = CoarseningFault::kAngles;
    if (made == 1 && !is_wanted(sheet.result())) return std::nullopt;
    CoarseningProof proof(input, goals.tolerance, control);
    std::optional<FaultyPlaces> places;
    double allowed = HUGE_VAL;
    for (int vain = 0;;) {
      const Coarsened& surface = sheet.result();
      CoarseningFaults faults = proof.check(surface);
      bool are_all_known = false;
      std::tie(faults.crossing_faces, are_all_known) =
          crossing_faces(input, surface, surface.positions.items(), around, control);
      if (count(faults) == 0 && are_all_known) {
        fault = CoarseningFault::kTopology;
        if (Topology({surface.positions, surface.faces, {}}, control) != before) return std::nullopt;
        fault = CoarseningFault::kNone;
        faults = last_faults(surface);
        if (count(faults) == 0) return ProvenCoarsening{sheet.take_result(), made};
      }
      fault =
          faults.crossing_faces.empty() && are_all_known ? CoarseningFault::kDistance : CoarseningFault::kIntersections;
      if (count(faults) == 0) return std::nullopt;
      const auto many = kManyFaults * static_cast<double>(surface.faces.size());
      const bool is_bad = !faults.crossing_faces.empty() || static_cast<double>(count(faults)) > many;
      if (made == 1 && !places && is_bad) break;
      // The first surface is too coarse in all of the places; later ones in those that are left.
      if (!places || made > kSurfacesWithoutKeeping) places.emplace(faults, surface);
      // Splitting alone does not help where vertices are too far from the input.
      const bool is_vain = static_cast<double>(count(faults)) > allowed;
      if (!is_vain) allowed = kFewer * static_cast<double>(count(faults));
      vain = is_vain ? vain + 1 : 0;
      if (vain > kVainRefinements || !sheet.refine(faults, is_vain, control)) break;
    }
    share = kShareAfterFaults;
    if (!places) continue;
    if (made > kSurfacesWithoutKeeping) {
      shares.keep(places->far, control);
      shares.keep(places->crossing, control);
    } else {
      shares.lower(places->far, kAfterDistance, control);
      shares.lower(places->crossing, kAfterIntersection, control);
    }
    if (!places->crossing.empty() && !std::exchange(are_gaps_known, true))
      shares.limit_by_gaps(around, goals.tolerance, control);
  }
  return std::nullopt;
}

}  // namespace remesh
