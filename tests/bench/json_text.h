/// Writes a mesh as the JSON that the daemon accepts.
#pragma once

#include <string>

#include "api/json_writer.h"
#include "core/mesh/mesh.h"

namespace remesh::bench {

inline std::string json_of(const TriangleMesh& mesh) {
  api::JsonWriter json;
  json.begin_object();
  json.key("vertices");
  json.begin_array();
  for (const Vec3& p : mesh.positions) {
    json.begin_array();
    for (const double x : {p.x, p.y, p.z}) json.number(x);
    json.end_array();
  }
  json.end_array();
  json.key("faces");
  json.begin_array();
  for (const Triangle& face : mesh.faces) {
    json.begin_array();
    for (const VertexId v : face) json.integer(v.value);
    json.end_array();
  }
  json.end_array();
  json.end_object();
  return json.take();
}

}  // namespace remesh::bench
