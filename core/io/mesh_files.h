/// Converts bytes to meshes and back, in all formats except JSON, which the layer above reads and writes.
#pragma once

#include <string>
#include <string_view>

#include "core/base/run_control.h"
#include "core/io/formats.h"

namespace remesh {

/// Reads OBJ, STL, PLY or OFF. See read_obj, read_stl, read_ply, read_off.
/// Errors:  kUnsupportedMediaType - another format; also those of the reader.
ReadResult read_mesh(Format format, std::string_view content, const ReadLimits& limits, RunControl& control);

/// Writes any format except JSON. See write_obj and the other writers.
/// Errors:  kNotAcceptable - JSON; also those of the writer.
std::string write_mesh(Format format, const WriterInput& input, RunControl& control);

}  // namespace remesh
