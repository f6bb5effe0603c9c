/// Claims of facets for surfaces: a surface grows from a few facets over their neighbours as long as the corners of
/// these lie on it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/stoppable.h"
#include "core/base/vec.h"
#include "core/geometry/surfaces/analytic_surface.h"
#include "core/geometry/surfaces/surface_fit.h"
#include "core/patches/recognition/facet_graph.h"
#include "core/patches/recognition/surface_gauge.h"

namespace remesh {

/// Facets that are claimed for a surface, in local units.
struct SurfaceClaim {
  AnalyticSurface shape;
  int side = 1;  ///< 1 if the facets' normals point to the positive side of the surface, otherwise -1
  std::vector<PatchId> facets;
  double tolerance = 0;       ///< no corner is farther from the surface than this
  std::vector<Vec2> profile;  ///< only a surface of revolution has one, see RecognisedSurface
  double area = 0;            ///< sum of the facets' areas
  double deviation = 0;       ///< largest distance of a corner from the surface
  bool is_clear = false;      ///< nearly all corners are so near to the surface that rounding alone explains them
  bool is_explained = true;   ///< the turns between the facets explain the facets' distance from the surface
  double chord_height = 0;    ///< the mean, weighted by area, of each facet's largest distance from the surface
  std::vector<SurfaceClaim>
      bands;  ///< only a surface of revolution has them: the cones and cylinders that it was made of
};

/// The claims, and which facets belong to which.
struct ClaimTable {
  explicit ClaimTable(std::size_t facets) : owner(facets, kNone) {}

  /// Adds a claim. Its facets belong to it from now on, even if they belonged to another one.
  void add(SurfaceClaim claim) {
    for (const PatchId p : claim.facets) owner[p] = static_cast<std::uint32_t>(claims.size());
    claims.push_back(std::move(claim));
  }

  IdVector<PatchId, std::uint32_t> owner;  ///< index in `claims`, or kNone
  std::vector<SurfaceClaim> claims;        ///< some may have lost all of their facets
};

/// The state of a facet while claims are made: whether it belongs to a claim, and how firmly.
enum class Taken : std::uint8_t {
  kFree,
  kWeakly,  ///< it belongs to a claim that a larger one may replace
};

/// The limits within which a surface grows.
struct ClaimGrowth {
  double tolerance = 0;  ///< the largest distance of a corner from the surface, in local units
  Taken may_replace = Taken::kFree;
  /// Even if its corners are near, the claim must end where its surface ends.
  bool is_doubtful = false;
};

/// Grows claims. It has scratch memory for all facets, so that a claim costs no more than its size.
class ClaimGrower {
 public:
  ClaimGrower(const FacetGraph& graph, RunControl& control);

  void set_taken(PatchId p, Taken taken) { taken_[p] = taken; }

  /// Grows a surface from facets that lie roughly on it, over facets that are not taken, or at most weakly.
  /// Output: nothing if no surface of this kind has enough facets to be believed.
  std::optional<SurfaceClaim> grow(const AnalyticSurface& start, std::span<const PatchId> seed,
                                   const ClaimGrowth& growth);

  /// Returns how much work was done so far. It is counted in steps, so that it is the same on every machine.
  std::uint64_t work() const { return work_; }

  /// Returns the facets that the last growth had when it was given up. There are none if the growth succeeded, or had
  /// too few facets for its kind.
  std::span<const PatchId> given_up() const { return given_up_; }

 private:
  bool fits(const SurfaceGauge& gauge, PatchId p, double tolerance, int side);
  /// Returns how many tolerances corners may be off while a growth has this number of facets.
  double slack(std::size_t members) const;
  bool expand(const SurfaceGauge& gauge, double tolerance, int side, Taken may_replace, std::size_t max_size,
              std::vector<PatchId>& members);
  enum class Precision : std::uint8_t { kGoodEnough, kExact };
  bool refit(AnalyticSurface& shape, std::span<const PatchId> members, Precision precision);
  void trim(const AnalyticSurface& shape, double tolerance, int side, std::vector<PatchId>& members);
  /// Removes facets over which the surface turns too much, and returns the mean of the chord heights of the others.
  double drop_uneven(const AnalyticSurface& shape, std::vector<PatchId>& members);
  /// Returns 1 minus the cosine of the largest angle by which the surface turns between corners of a facet.
  double turn(const SurfaceGauge& gauge, PatchId p) const;
  /// Sorts values of facets, and returns their median by area: half of the area has smaller values.
  double median_by_area(std::vector<std::pair<double, PatchId>>& values) const;
  /// Returns whether the facets around a claim leave its surface so gradually that the claim is a piece of a larger
  /// surface, which is only near the claimed one.
  bool goes_on_beyond(const SurfaceGauge& gauge, const SurfaceClaim& claim);
  bool is_explained(const SurfaceClaim& claim) const;
  bool grow_members(AnalyticSurface& shape, int side, Taken may_replace, std::vector<PatchId>& members);
  std::optional<SurfaceClaim> conclude(AnalyticSurface shape, int side, std::vector<PatchId> members);

  const FacetGraph& graph_;
  double tolerance_ = 0;      ///< of this growth
  bool is_doubtful_ = false;  ///< of this growth
  double first_slack_ = 1;    ///< the slack with which the growth began, see slack()
  const RunControl& control_;
  StopCheck check_;
  IdVector<PatchId, Taken> taken_;
  IdVector<PatchId, std::uint32_t> mark_;  ///< the last growth that took the facet
  std::uint32_t growth_ = 0;
  std::uint64_t work_ = 0;
  std::vector<Vec3> points_;
  std::vector<VertexId> vertices_;
  std::vector<std::pair<double, PatchId>> values_;
  std::vector<PatchId> given_up_;
};

}  // namespace remesh
