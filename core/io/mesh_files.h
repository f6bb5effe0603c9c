/// Converts bytes to meshes and back, in all formats except JSON, which the layer above reads and writes.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/run_control.h"
#include "core/io/common/boundaries.h"
#include "core/io/formats.h"

namespace remesh {

/// Reads any format that has a reader. See read_obj and the other readers.
/// Errors:  kUnsupportedMediaType - another format; also those of the reader.
ReadResult read_mesh(Format format, std::string_view content, const ReadLimits& limits, RunControl& control);

/// Writes any format except JSON. See write_obj and the other writers.
/// Errors:  kNotAcceptable - JSON; also those of the writer.
std::string write_mesh(Format format, const WriterInput& input, RunControl& control);

/// The names of labels that write_mesh changes, because programs that read the format would not read them.
std::vector<RenamedLabel> renamed_labels(Format format, const WriterInput& input, RunControl& control);

/// The lines of Gmsh's language with which Gmsh fills the surface in a file by write_mesh.
/// Output: none if the format needs none, or if the surface does not enclose volumes.
std::vector<std::string> filling_lines(Format format, const WriterInput& input, RunControl& control);

}  // namespace remesh
