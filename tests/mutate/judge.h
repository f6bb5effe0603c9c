/// Checks an answer independently, from the bytes that were written and the mesh that was read.
///
/// It calls neither the checker nor any helper of the pipeline. All that it knows about the run is what the report
/// claims.
#pragma once

#include <string>
#include <vector>

#include "api/job.h"
#include "core/mesh/mesh.h"

namespace remesh::mutate {

struct Objection {
  std::string kind;  ///< a short name, by which objections are counted
  std::string text;  ///< the explanation with numbers
};

/// Looks for broken promises of the answer's report. Numbers must be finite, and counts must be those of the mesh. A
/// closed surface must stay closed with one winding. No triangle may lack area unless the input had such. Area and
/// volume must stay within the changes that the report permits. Points of each surface must be near the other one. As
/// many faces must be beyond the bounds as are listed. Small meshes must have no new intersections.
/// Input:   the mesh as it was read, and the answer to it.
/// Cost:    some dozens of samples times the faces; for intersections, some thousand exact tests of pairs.
std::vector<Objection> judge(const PolygonMesh& input, const api::RemeshAnswer& answer);

}  // namespace remesh::mutate
