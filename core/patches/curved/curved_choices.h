/// The decisions about the curved surfaces of a mesh. There is no geometry here.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/ids.h"
#include "core/patches/charts/curved_patches.h"

namespace remesh {

/// The distances by which curved surfaces are moved outwards, so that the result keeps volumes. The offsets are
/// estimates at first, and results correct them.
struct OffsetChoices {
  std::vector<SurfaceId> left;                       ///< surfaces that stay where they are, ascending
  IdVector<SurfaceId, std::optional<double>> known;  ///< offsets in local units, or empty: all are estimated
  int corrections = 0;
  bool operator==(const OffsetChoices&) const = default;

  bool is_left(SurfaceId surface) const;
  /// Returns whether better offsets have rarely been taken yet.
  bool is_better_estimate_worth_while() const;
  void take(const IdVector<SurfaceId, double>& better);
  /// Leaves surfaces where they are from now on, and forgets the offsets of these and of those whose limits have
  /// changed. They are estimated anew, and corrected once more.
  void leave(std::span<const SurfaceId> surfaces, std::span<const SurfaceId> changed);
};

/// A curved patch that may be at fault for a failure.
struct CurvedFault {
  std::vector<FaceId> faces;  ///< the input faces that the patch covers, ascending
  SurfaceId surface;
  /// The surface itself if it is moved outwards, or otherwise those that are moved and share vertices with it.
  std::vector<SurfaceId> moved;
  bool operator==(const CurvedFault&) const = default;
};

/// Facets of surfaces that stay because they are coarser than joined patches, or have turned out to be finer.
struct CoarserFaces {
  std::vector<FaceId> coarser, finer;  ///< the input faces that the facets cover, ascending
  /// The numbers of triangles that the facets of surfaces may have which are left from now on.
  std::vector<std::pair<SurfaceId, double>> allowed;
  bool are_compared = false;  ///< facets that were left before have been compared with what was allowed to them
  bool operator==(const CoarserFaces&) const = default;

  bool are_any() const { return !coarser.empty() || !finer.empty(); }
};

/// The rungs of curved patches, and the offsets of their surfaces.
struct CurvedChoices {
  std::vector<CurvedRung> rung;  ///< one per input face; empty as long as all facets are joined
  bool are_all_facets = false;   ///< too many patches have failed, so none is joined any more
  int steps = 0;                 ///< how often curved patches have been taken a rung up
  int leavings = 0;              ///< how often facets were left because they are coarser
  /// How many triangles the facets of surfaces may have that were left. Nothing is known of others.
  IdVector<SurfaceId, std::optional<double>> allowed;
  bool are_left_uncompared = false;  ///< facets were left, and have not been compared with what is allowed yet
  OffsetChoices offsets;
  bool operator==(const CurvedChoices&) const = default;

  /// Returns whether some facets may not be joined, or only within finer limits.
  bool are_any() const { return are_all_facets || !rung.empty(); }
  /// Returns the highest rung among the input faces that a face covers.
  CurvedRung rung_of(std::span<const FaceId> covered) const;
  /// Returns whether facets may still be left because they are coarser. The patches beside them have finer boundaries
  /// then, and may be the next ones.
  bool may_leave_facets() const;
};

/// Takes curved patches a rung up: first they get finer limits, and then they become facets again. If their surfaces
/// are moved outwards, finer limits come first, then the surfaces stay where they are, and then all begins anew. A
/// chain of neighbours that fail one after the other must not cost a step for each of them. So after some steps,
/// patches become facets at once, and after some more, all curved patches do.
/// Input: `is_patient` tells whether finer limits are worth an attempt; `are_any_moved` whether surfaces are moved
///        outwards; `count` is the number of all input faces.
CurvedChoices after_faults(CurvedChoices now, std::span<const CurvedFault> faults, bool is_patient, bool are_any_moved,
                           std::size_t count);

/// Leaves facets that would probably be finer if they were joined, and joins those again that have turned out to be
/// finer as facets.
CurvedChoices after_comparison(CurvedChoices now, const CoarserFaces& faces, std::size_t count);

}  // namespace remesh
