/// The long arrays of a JSON mesh, read without a parser's events.
#pragma once

#include <string_view>

#include "core/base/run_control.h"
#include "core/io/formats.h"
#include "core/mesh/mesh.h"

namespace remesh::api {

/// Thrown where an array is not plain: another reader knows what to make of it.
struct NotPlain {};

/// Reads an array of coordinate triples into `mesh`.
/// Input:   the whole text, and where in it the array's first element or closing bracket stands.
/// Output:  where its closing bracket stands. Numbers as nlohmann-json hands them on: correctly
///          rounded, and an integer -0 is 0.
/// Errors:  NotPlain - it is no such array of finite numbers, or has more of them than `limits`;
///          kCancelled, kTimeout - through `control`.
std::size_t read_plain_vertices(std::string_view text, std::size_t begin, const ReadLimits& limits, RunControl& control,
                                PolygonMesh& mesh);
/// The same of faces: arrays of three or more whole numbers of up to eight digits.
std::size_t read_plain_faces(std::string_view text, std::size_t begin, const ReadLimits& limits, RunControl& control,
                             PolygonMesh& mesh);

}  // namespace remesh::api
