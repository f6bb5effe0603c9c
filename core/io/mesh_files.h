/// Meshes from bytes and to bytes, in any format that is not JSON (which the layer above reads and writes).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/io/formats.h"

namespace remesh {

/// Reads OBJ, STL, PLY or OFF; see read_obj, read_stl, read_ply, read_off.
/// Errors:  kUnsupportedMediaType - another format; else those of the reader.
ReadResult read_mesh(Format format, std::string_view content, const ReadLimits& limits, RunControl& control);

/// Writes any format but JSON; see write_obj, ... `comments` go where the format has them. `face_patch` goes where it
/// has cell data or groups.
/// Errors:  kNotAcceptable - JSON; else those of the writer.
std::string write_mesh(Format format, const TriangleMesh& mesh, const IdVector<FaceId, PatchId>& face_patch,
                       const std::vector<std::string>& comments, RunControl& control);

}  // namespace remesh
