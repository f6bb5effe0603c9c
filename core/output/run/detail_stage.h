/// Removes details from a surface after it has been divided into patches.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/ids.h"
#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/base/stopwatch.h"
#include "core/mending/details/remove_details.h"
#include "core/mending/details/specks.h"
#include "core/mending/preparation.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/output/run/candidate.h"
#include "core/patch_types/patch_set.h"
#include "core/patches/meshing/triangulated_patches.h"
#include "core/verify/claim/claim.h"
#include "core/verify/claim/verdict.h"

namespace remesh {

/// Makes the triangles of a surface's patches, without the details among them, the surface on which all goes on. So
/// details are looked for where they matter: between vertices that would stay.
class DetailStage {
 public:
  /// The details that count. Lengths are in model units.
  struct Limits {
    double size = 0;  ///< 0: nothing is removed
    double plane_tolerance = 0;
    bool is_size_given = false;  ///< false: the size is the plane tolerance
  };
  /// The largest number of times that details are removed. Each time may show smaller ones.
  static constexpr int kMaxPasses = 3;

  /// Forgets everything. The next surface is another one.
  void reset(const Options& options, double plane_tolerance);

  /// Returns whether details should be looked for in the triangles of the patches.
  bool is_wanted() const { return limits_.size > 0 && passes_ < kMaxPasses && !is_done_; }
  /// Returns whether the patches have any, or the surface has open edges, between which there may be slits.
  /// Cost: O(triangles).
  bool are_there(const TriangulatedPatches& triangulated, const Surface& surface, const Adjacency& adjacency,
                 RunControl& control) const;
  /// Nothing more is looked for.
  void stop() { is_done_ = true; }

  /// Holds the surface as it is, and how it became so.
  struct Context {
    const PolygonMesh& input;  ///< as it was read
    const PatchSet& patches;   ///< those of the prepared surface
    InputIntersections intersections;
    double plane_tolerance;  ///< model units
    double weld_tolerance;   ///< model units
    /// Has one entry per input face, or is empty. The corners of faces marked there stay.
    const std::vector<std::uint8_t>& kept;
  };
  /// Removes details from the triangles of the patches, after it has proven that these are the prepared surface.
  /// Input:   a candidate that has been triangulated without failures, and no more. It is empty afterwards.
  /// Output:  whether anything was removed and proven. Then the prepared surface is the candidate's triangles, without
  ///          the details. Its faces have the sources of the faces under them. If not, nothing more is looked for.
  /// Errors:  kCancelled, kTimeout - through `control`.
  /// Cost:    that of remove_details, of a check and of a search for intersections.
  bool run(const Context& context, Candidate& candidate, Prepared& prepared, Stopwatch& watch, RunControl& control);

  bool is_any_removed() const { return passes_ > 0; }
  /// Returns the size below which details were removed, in model units.
  double size() const { return limits_.size; }
  /// Returns how far the surface is from the one before, in both directions, in model units.
  double bound() const { return bound_; }
  /// Returns by how much the volume has changed at most, in cubed model units.
  double volume_bound() const { return volume_bound_; }
  /// Returns the tolerance with which planes that have been bent a little are still planes. It is at least the plane
  /// tolerance, and all bounds together are within the size.
  double plane_tolerance() const { return limits_.plane_tolerance; }
  /// Tells what was removed. Something was.
  Diagnostic removal() const;
  /// Tells what was removed, and, if a size was given, which edges of the result are shorter than a third of it, and
  /// which separate parts are no larger than it.
  void tell(const Candidate& result, const PatchSet& patches, const Surface& surface,
            std::vector<Diagnostic>& diagnostics, RunControl& control) const;
  /// Returns the patch of each input face: that of a face that was made of its patch.
  IdVector<FaceId, PatchId> patches_of_input(const PatchSet& patches) const;

 private:
  bool remove(const Context& context, const Candidate& candidate, const Verdict& verdict, Prepared& prepared,
              RunControl& control);
  Specks specks_left(const Candidate& result, RunControl& control) const;

  /// The patches that the input's faces had, and the faces of the present surface that were made of each.
  struct Descent {
    IdVector<FaceId, PatchId> patch_of_input;
    IdVector<PatchId, FaceId> face_of_patch;  ///< invalid if none was
  };

  Limits limits_;
  bool is_done_ = false;
  int passes_ = 0;
  double bound_ = 0, volume_bound_ = 0;
  std::uint64_t joined_edges_ = 0, closed_slivers_ = 0, removed_specks_ = 0, closed_slits_ = 0;
  Diagnostic removed_;  ///< the input faces under what was removed
  bool is_effort_spent_ = false;
  std::optional<Descent> descent_;
};

}  // namespace remesh
