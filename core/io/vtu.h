/// VTK XML, unstructured grid.
#pragma once

#include <string>
#include <vector>

#include "core/base/ids.h"
#include "core/io/formats.h"

namespace remesh {

/// Writes a `.vtu` file: triangles, coordinates as doubles, arrays as base64. Cell data: `patch` of each face;
/// `min_angle_deg`, `radius_edge_ratio`, `aspect_ratio`, by Verdict's definitions (0 where the area is zero and a ratio
/// would be infinite); `object`, `group`, `material` where the mesh has them, as numbers whose names are in XML
/// comments, as are `comments`.
/// Errors: kCancelled, kTimeout - through `control`.
/// Cost:   O(output).
std::string write_vtu(const TriangleMesh& mesh, const IdVector<FaceId, PatchId>& face_patch,
                      const std::vector<std::string>& comments, RunControl& control);

}  // namespace remesh
