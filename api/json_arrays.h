/// Fast readers for the long arrays of a JSON mesh, which work without a parser's events.
#pragma once

#include <string_view>

#include "core/base/run_control.h"
#include "core/io/formats.h"
#include "core/mesh/mesh.h"

namespace remesh::api {

/// Thrown if an array needs the general reader, because it is unusual or wrong.
struct NotPlain {};

/// Reads an array of coordinate triples into `mesh`, which is empty; if it is null, the array is only checked.
/// Input:   `text` - the whole text; `begin` - the position in it of the array's first element or closing bracket.
/// Output:  the position of the closing bracket. The numbers are those that nlohmann-json gives: correctly rounded,
///          and an integer -0 is 0.
/// Errors:  NotPlain - it is not such an array of finite numbers, or has more of them than `limits` permit;
///          kCancelled, kTimeout - through `control`.
std::size_t read_plain_vertices(std::string_view text, std::size_t begin, const ReadLimits& limits, RunControl& control,
                                PolygonMesh* mesh);
/// Reads an array of faces into `mesh`, as read_plain_vertices does. Each face is an array of three or more whole
/// numbers of up to eight digits.
/// Input:   `text` and `begin`, as for read_plain_vertices.
/// Output:  the position of the closing bracket.
/// Errors:  NotPlain - it is not such an array, or has more faces than `limits` permit or more corners than a mesh can
///          have; kCancelled, kTimeout - through `control`.
std::size_t read_plain_faces(std::string_view text, std::size_t begin, const ReadLimits& limits, RunControl& control,
                             PolygonMesh* mesh);

}  // namespace remesh::api
