/// Meshes and options from JSON, straight into flat arrays.
#pragma once

#include <string_view>

#include "api/options.h"
#include "core/base/run_control.h"
#include "core/io/formats.h"

namespace remesh::api {

/// Reads a bare mesh, {"vertices": [[x,y,z],...], "faces": [[i,j,k,...],...], "face_groups": [g,...]}, or a mesh beside
/// its options, {"mesh": {...}, "options": {...}}; keys in any order.
/// Output:  polygons as listed; `face_groups` become group labels, named by the number. Options go to `options`. Keys
///          that are not understood are skipped and counted as `attribute_dropped`.
/// Holds:   no document tree is built; memory is bounded by `limits` and the text's length.
/// Errors:  kMalformedJson - with the line: not JSON, nested too deep, a known key given twice; kInvalidMesh - JSON,
///          but not of this shape; kIndexOutOfRange, kNonfiniteCoordinate - with the face or vertex, from 0; kEmptyMesh
///          - no face; kMeshTooLarge - past `limits`; of an option, what OptionReader::add says.
/// Cost:    O(length); twice of what ends with an error.
ReadResult read_json(std::string_view text, const ReadLimits& limits, RunControl& control, OptionReader& options);

/// The same, every number by an event of nlohmann-json's parser: what read_json falls back to where anything is odd or
/// wrong.
ReadResult read_json_by_events(std::string_view text, const ReadLimits& limits, RunControl& control,
                               OptionReader& options);

/// Reads an options object alone: {"plane_tolerance": 1e-5, "repair": ["degenerate"]}.
/// Errors: kMalformedJson; kInvalidOption; what OptionReader::add says.
void read_json_options(std::string_view text, RunControl& control, OptionReader& options);

}  // namespace remesh::api
