/// A remeshed surface that has yet to be verified.
#pragma once

#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/stopwatch.h"
#include "core/base/vec.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/output/result/assembly.h"
#include "core/patch_types/patch_set.h"
#include "core/patches/charts/curved_patches.h"
#include "core/patches/meshing/partition.h"
#include "core/patches/meshing/triangulated_patches.h"
#include "core/patches/planar/input_intersections.h"
#include "core/refinement/goals/goals.h"
#include "core/refinement/goals/unrefined.h"
#include "core/refinement/rounds/refinement.h"
#include "core/verify/claim/claim.h"
#include "core/verify/claim/verdict.h"

namespace remesh {

/// The triangles of all patches, first as separate meshes and then as one mesh.
struct Candidate {
  TriangulatedPatches triangulated;
  bool has_chords = false;          ///< some edges inside patches are also edges of others, and flips do not help
  bool are_chords_flipped = false;  ///< the meshes are not as they were triangulated
  Refinement refinement;
  Assembled assembled;
  IdVector<VertexId, Vec3> positions;  ///< those of `assembled`
  UnrefinedFaces unrefined;            ///< those of `assembled`
  /// New places of vertices of the surface on which the patches were triangulated, ascending.
  std::vector<std::pair<VertexId, Vec3>> moved;

  Candidate() = default;
  /// Frees the meshes in parallel, because there may be a million.
  ~Candidate();
  Candidate(const Candidate&) = delete;
  Candidate& operator=(const Candidate&) = delete;

  /// Flips edges inside patches that are also edges of others (see flip_chords), unless that was in vain before.
  void flip_chords(std::size_t vertex_end, RunControl& control);
  /// Removes all triangles, so that it can take those of another attempt.
  void clear();
  /// Returns whether there are triangles.
  bool is_triangulated() const { return !triangulated.meshes.empty(); }
  /// Removes what was made of the patches' triangles, and brings these back as they were before refinement.
  void undo_refinement();
  /// Removes what was made of the patches' triangles, which were not refined. If edges of them were changed for the
  /// sake of chords, the triangles go as well.
  void undo_assembly();

 private:
  void forget_refinement();
};

/// Makes one mesh of the patches' meshes. If there are `goals`, finds the triangles that miss them.
/// Errors:  kCancelled, kTimeout - through `control`.
/// Cost:    O(vertices + triangles).
void assemble(Candidate& candidate, const Surface& surface, const Goals* goals, RunControl& control);

/// Finds the triangles of a candidate that miss the goals anew, after it is known which of them miss sizes.
/// Cost: O(triangles).
void list_unrefined(Candidate& candidate, const Goals& goals, RunControl& control);

/// Compares the triangles that a floor under the lengths of edges leaves in plane patches with the surface's own
/// triangles and with those of its patches before refinement. Returns whether the floor leaves more triangles below the
/// bound on angles, or a smaller least angle, than either of them has. Such a floor is too low: it lets edges be cut
/// that cannot be cut often enough.
/// Input: an assembled candidate. Its patches were triangulated on `with_cuts`. `curved` is null if no patch is curved.
/// Cost:  O(triangles).
bool has_worse_angles(Candidate& candidate, const Surface& surface, const Surface& with_cuts,
                      const CurvedPatches* curved, const Goals& goals, RunControl& control);

/// Gives triangles other reasons for missing the goals, before some vertices are moved by a little: all those that meet
/// the goals, and those with a moved vertex that lie across an angle of the input, which asks for equal distances.
/// These reasons count if the triangles miss a goal afterwards.
/// Input: a candidate that has been assembled with goals; `is_moved` has one entry per vertex of the surface or of the
///        refinement.
/// Cost:  O(triangles).
void replace_reasons(Candidate& candidate, std::span<const std::uint8_t> is_moved, UnrefinedReason reason);

/// Makes one mesh of the patches' meshes again, after some vertices were moved by a little. Triangles that miss the
/// goals only since then get this reason, and so do those with a moved vertex that lie across an angle of the input,
/// which asks for equal distances.
/// Input:  a candidate that has been assembled with the same goals; `is_moved` has one entry per vertex of the surface
///         or of the refinement.
/// Errors: kCancelled, kTimeout - through `control`.
/// Cost:   O(vertices + triangles).
void assemble_again(Candidate& candidate, const Surface& surface, const Goals* goals,
                    std::span<const std::uint8_t> is_moved, UnrefinedReason reason, RunControl& control);

/// The information that the check needs besides the candidate.
struct CheckedAgainst {
  const PolygonMesh* input;  ///< null if the surface was not made of it by mending alone
  const Surface& surface;
  const PatchSet& patches;
  const InputIntersections& intersections;
  double plane_tolerance = 0;  ///< in model units
  double weld_tolerance = 0;   ///< in model units
  const Goals* goals = nullptr;
  const CurvedPatches* curved = nullptr;            ///< null if no patch is curved
  std::span<const CurvedClaim> curved_claims = {};  ///< one per curved patch
  std::span<const std::uint8_t> frozen = {};        ///< patches that refinement left as they were; see RefinementClaim
  std::span<const std::uint32_t> edge_order = {};   ///< see Claim::surface_edge_order
  /// If this is set, it finds out which triangles of the candidate miss sizes that vary. It is called only if all else
  /// is right.
  std::function<void(Candidate&)> measure_sizes = {};
};

/// Checks the candidate against the surface from which it was made (see verify).
/// Input: the candidate lists the triangles that miss the goals, except those that `measure_sizes` finds. These are
///        added to its list.
Verdict check(Candidate& candidate, const CheckedAgainst& against, RunControl& control);

/// Makes one mesh of patches that were triangulated and not refined.
/// Input: a candidate that has been triangulated without failures, and no more.
void assemble_triangles(Candidate& candidate, const CheckedAgainst& against, Stopwatch& watch, RunControl& control);

/// Makes one mesh of patches that were triangulated and not refined, and checks it. So a stage can take these triangles
/// for the surface.
/// Input: as above.
Verdict check_triangles(Candidate& candidate, const CheckedAgainst& against, Stopwatch& watch, RunControl& control);

/// The pairs of patches that intersect in the input.
InputIntersections intersecting_patches(const FoundIntersections& found, const PatchSet& patches);

/// The pairs of patches that intersect in the result. They include patches that fold over themselves in the input,
/// because the check does not look into all of these.
InputIntersections patches_that_still_intersect(InputIntersections of_input, const Verdict& verdict,
                                                const IdVector<FaceId, PatchId>& face_patch);

}  // namespace remesh
