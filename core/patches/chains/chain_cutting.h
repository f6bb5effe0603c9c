/// Cuts one chain of a patch boundary anew, so that its pieces are as long as the curved patches beside it allow.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/planes/plane.h"
#include "core/geometry/surfaces/analytic_surface.h"
#include "core/mesh/surface.h"
#include "core/patches/chains/boundary_chains.h"
#include "core/patches/chains/chain_gaps.h"

namespace remesh {

/// The properties of a patch that the cutting of curves needs.
struct PatchSurface {
  const AnalyticSurface* shape = nullptr;  ///< in model units; null for a plane, for which `plane` counts
  Plane plane;                             ///< in local units, as in PatchSet::planes
  double tolerance = 0;                    ///< curved: how far the result may be from the input there, in model units
  double max_turn = 0;                     ///< curved: the angle by which edges may turn, in radians
  /// Curved: max distance of a dropped node from its chord where no formula is known. 0: half of the tolerance.
  double sideways = 0;
  /// Curved: max distance of new pieces of a curve with a formula from the surface, in model units.
  double max_depth = HUGE_VAL;
  double area = HUGE_VAL;  ///< curved: area of the patch, in squared local units
  /// Curved: how far a chord of a section may leave the section along the surface, if it is no circle around the axis
  /// of a cone. 0: as far as the tolerance allows.
  double along = 0;
  /// Curved: the max distance of an essential vertex from the surface, in model units, if it is larger than that of
  /// CurveRules.
  double fit_tolerance = 0;
};

/// The rules by which curves are recognised.
struct CurveRules {
  /// The largest distance of an essential vertex from the surfaces on which it is said to lie, in model units.
  double fit_tolerance = 0;
  double feature_angle = 0;  ///< a chain without a formula has a corner where it bends by more, in radians
  /// New pieces are no longer than this many times the width of a curved patch beside them, because triangles over
  /// longer pieces would have smaller angles than is allowed.
  double max_length_per_width = HUGE_VAL;
};

/// The patches beside a chain. Each patch is listed once.
struct ChainSides {
  std::vector<PatchSurface> curved;  ///< ordered by their shapes
  std::vector<Plane> planes;         ///< those of the planar patches, in model units, in the order of `planar`
  std::vector<PatchId> planar;       ///< ordered by their planes
};

/// The new pieces of a chain, or of a part of it between two corners that bend. Its ends stay.
struct ChainCut {
  std::vector<ChainNode> nodes;     ///< those of the input
  std::vector<std::uint32_t> kept;  ///< those nodes between the ends that stay, ascending
  std::vector<Vec3> points;         ///< new vertices in the place of all nodes between the ends, in order
  /// A place in the middle of the curve, if no node is left between the ends and the curve has a formula.
  Vec3 middle;
  bool has_middle = false;
};

/// The input that all chains share.
struct ChainCutting {
  const Surface& surface;
  const IdVector<VertexId, std::uint8_t>& forced;
  const ChainGaps& gaps;
  CurveRules rules;
  const RunControl& control;
};

/// Cuts a chain.
/// Input:  the chain of the given number; `sides` has a curved patch at least.
/// Output: appends the parts of the chain that change. A part that stays as it is has no entry. Returns whether some
///         part has more pieces than the tolerances require, because another boundary of a planar patch is near.
/// Holds:  - a chain with a formula has equal pieces, as seen from its axis. Their number is the smallest for which
///         each piece turns by at most the smallest `max_turn` and both polylines are within the smallest `tolerance`
///         of each other. A closed chain has at least three. If the turn is not limited to a third of a circle, each
///         piece turns by at most a sixth. Where a curved patch is narrow, pieces are no longer than
///         `max_length_per_width` allows. If the input's pieces are neither larger nor more, they stay.
///         - a chain without a formula keeps some of its nodes. Each node that is dropped is within the tolerance of
///           its chord, in order along it, and the normals of each curved surface turn by at most `max_turn` between
///           two nodes that stay, unless these are neighbours in the input.
///         - a chain with a forced vertex between its ends stays as it is.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n log n).
bool cut_chain(std::uint32_t chain, std::span<const ChainNode> nodes, const ChainSides& sides,
               const ChainCutting& cutting, std::vector<ChainCut>& cuts);

}  // namespace remesh
