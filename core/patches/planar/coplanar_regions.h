/// Groups faces that lie in one plane.
#pragma once

#include "core/base/run_control.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/face_geometry.h"
#include "core/mesh/surface.h"
#include "core/patches/planar/regions.h"

namespace remesh {

/// Gives a region to every face that has none. Faces that are connected over manifold edges are one region if they fit
/// one plane. If they do not, regions grow from the largest face over such edges, layer by layer.
/// Holds:  every corner of every face of a region is within half the tolerance of the region's plane, and no face has
///         the opposite orientation. If a face is too thin for its normal to be meaningful (height under two
///         tolerances), only its corners are tested. Two triangles are not joined over their common edge if they bend
///         there by more than kUnquestionedBend and by more than the rounding of printed digits explains, even if one
///         plane is within the tolerance of both. For the four corners of two triangles, this is tested exactly; for
///         many corners, that is impossible. Regions are edge-connected. They do not creep along a curved surface,
///         because all faces are tested against the one final plane. Neither the order of faces and vertices nor
///         scaling by powers of two changes the regions.
/// Cost:   O(n log n); on the caller's TBB arena. The parallel parts are islands, which are faces connected over edges
///         whose two faces may fit one plane.
/// Source: J. Vermaak, The Surface Remeshing Module in ChiTech, 2018, section 2; rules.md, Coplanarity;
///         rules.md, Thin faces.
void coplanar_regions(const Surface& surface, const Adjacency& adjacency, const FaceGeometries& geometry,
                      const CoplanarityRule& rule, Regions& regions, RunControl& control);

}  // namespace remesh
