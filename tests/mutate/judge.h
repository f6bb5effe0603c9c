/// An independent check of an answer: from the bytes that were written and the mesh that was read.
///
/// It calls neither the checker nor any helper of the pipeline; what it knows of the run is the report's claims.
#pragma once

#include <string>
#include <vector>

#include "api/job.h"
#include "core/mesh/mesh.h"

namespace remesh::mutate {

struct Objection {
  std::string kind;  ///< a short name, by which findings are counted
  std::string text;  ///< with the numbers
};

/// Looks for what the answer breaks of the promises that its report makes: numbers are finite, counts are those of the
/// mesh, closed stays closed with one winding, no triangle without area that the input lacked, area and volume within
/// what the report allows, points of both surfaces near the other one, faces beyond the bounds as many as are listed,
/// no new intersections (of small meshes).
/// Input:   the mesh as read, and the answer to it.
/// Cost:    some dozens of samples times the faces; of intersections, some thousand pairs exactly.
std::vector<Objection> judge(const PolygonMesh& input, const api::RemeshAnswer& answer);

}  // namespace remesh::mutate
