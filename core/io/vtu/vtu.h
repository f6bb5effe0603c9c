/// Reads VTK's formats, and writes the XML format for unstructured grids.
#pragma once

#include <string>
#include <string_view>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/io/common/format.h"

namespace remesh {

/// Returns whether a text begins as VTK's legacy format does.
bool is_legacy_vtk(std::string_view text);

/// Reads VTK's XML formats for unstructured grids (`.vtu`) and for surfaces (`.vtp`), and the legacy format of both.
/// Input:   arrays as text, in base64, or appended raw or in base64, also packed by zlib; either byte order; any number
///          of pieces. The legacy format as text or binary, of any version up to 5.
/// Output:  triangles, quadrilaterals, polygons, pixels and strips of triangles in the order of the cells; faces of
///          higher order by their corners. Cell data `object`, `group` and `material` are labels, and so are
///          `gmsh:physical` and `medit:ref`, as groups. Their names are those that write_vtu gives to components, else
///          their digits. Other cells and other arrays are counted as attribute_dropped.
/// Errors:  with the byte: kInvalidMesh - not VTK's format, another kind of data, an array that is packed otherwise or
///          has another length than its piece tells; kIndexOutOfRange, kNonfiniteCoordinate - also with the element;
///          kMeshTooLarge - more than `limits`. kEmptyMesh - no face; kCancelled, kTimeout - through `control`.
/// Cost:    O(content + points + cells); an array takes no more memory than its piece tells, and no more than the
///          limits allow.
ReadResult read_vtu(std::string_view content, const ReadLimits& limits, RunControl& control);

/// Writes a `.vtu` file: triangles, coordinates as doubles, arrays as base64. The cell data of each face are:
/// `patch`; `surface`, if the patches' surfaces are known; `min_angle_deg`, `radius_edge_ratio` and `aspect_ratio` by
/// the definitions of the Verdict library (0 where the area is zero and a ratio would be infinite); `object`, `group`
/// and `material` if the mesh has them, as numbers. The names for these numbers are in XML comments, and if there are
/// at most 1,000 of a kind, they are those of the components of an array `object_names`, `group_names` or
/// `material_names` in the field data. `comments` are in XML comments.
/// Errors: kCancelled, kTimeout - through `control`.
/// Cost:   O(output).
std::string write_vtu(const WriterInput& input, RunControl& control);

}  // namespace remesh
