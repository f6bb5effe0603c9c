/// Reads meshes and options from JSON directly into flat arrays.
#pragma once

#include <string_view>

#include "api/options.h"
#include "core/base/run_control.h"
#include "core/io/formats.h"

namespace remesh::api {

/// Reads a bare mesh, {"vertices": [[x,y,z],...], "faces": [[i,j,k,...],...], "face_groups": [g,...]}, or a mesh
/// together with options, {"mesh": {...}, "options": {...}}. The keys may be in any order.
/// Output:  the polygons in their order. `face_groups` become group labels whose names are the numbers. `labels` are
///          those of an answer: {"group": {"names": [...], "of_face": [...]}, ...}. Options go to `options`. Unknown
///          keys are skipped and counted as `attribute_dropped`.
/// Holds:   no document tree is built; memory is bounded by `limits` and the length of the text.
/// Errors:  kMalformedJson - with the line: not JSON, nested too deeply, a known key given twice; kInvalidMesh - JSON
///          of another shape; kIndexOutOfRange, kNonfiniteCoordinate - with the face or vertex, from 0; kEmptyMesh -
///          no face; kMeshTooLarge - more than `limits`; for an option, the errors of OptionReader::add.
/// Cost:    O(length); twice as much if it ends with an error.
ReadResult read_json(std::string_view text, const ReadLimits& limits, RunControl& control, OptionReader& options);

/// Reads the same texts, but gets every number as an event of nlohmann-json's parser. read_json falls back to it if
/// anything is unusual or wrong.
ReadResult read_json_by_events(std::string_view text, const ReadLimits& limits, RunControl& control,
                               OptionReader& options);

/// Checks a text that read_json is to read later, without building its mesh. The text must be JSON, and the options in
/// it must be valid. The first error in the mesh itself ends the check and is not reported, since read_json will.
/// Output:  options go to `options`.
/// Holds:   only the parser takes memory, because it copies one string of the text at a time.
/// Errors:  kMalformedJson - with the line; those of OptionReader::add.
/// Cost:    as read_json.
void check_json_text(std::string_view text, const ReadLimits& limits, RunControl& control, OptionReader& options);

/// Reads an options object alone: {"plane_tolerance": 1e-5, "repair": ["degenerate"]}.
/// Errors: kMalformedJson; kInvalidOption; those of OptionReader::add.
void read_json_options(std::string_view text, RunControl& control, OptionReader& options);

}  // namespace remesh::api
