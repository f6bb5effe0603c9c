/// Reads 3MF.
#pragma once

#include <string_view>

#include "core/base/run_control.h"
#include "core/io/common/format.h"

namespace remesh {

/// Reads `.3mf`.
/// Input:   a ZIP archive with a model as XML. Objects must stand before those that use them as components.
/// Output:  the triangles of all items of the build, in their order, with the transforms applied: that of a component
///          first, that of its item last. The names of the objects that the build lists are objects, those of base
///          materials are materials. Coordinates stay in the unit of the model, which `unit` tells; `up_axis` is `z`.
///          Colours, textures and other properties are counted as attribute_dropped.
/// Errors:  with the byte of the archive or of the model's XML: kInvalidMesh - not 3MF, an extension that is required,
///          an object that is not there; kIndexOutOfRange, kNonfiniteCoordinate; kMeshTooLarge - more than `limits`,
///          also by items that use an object again; kDecompressedTooLarge. kEmptyMesh - no face; kCancelled, kTimeout.
/// Cost:    O(model + output).
/// Source:  3MF Consortium, 3D Manufacturing Format Core Specification 1.3.
ReadResult read_threemf(std::string_view content, const ReadLimits& limits, RunControl& control);

}  // namespace remesh
