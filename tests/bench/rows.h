/// The measurements of remesh_bench, in a form that scripts read.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "api/json_writer.h"

namespace remesh::bench {

/// One measurement: the time that it took to do `what` with a `subject` of this size.
struct Row {
  std::string part;  ///< the part of remesh_bench that measured it
  std::string subject;
  std::string what;
  std::uint64_t size = 0;
  double ms = 0;                ///< a median
  std::uint64_t triangles = 0;  ///< how many were made; 0 if they are not counted
};
using Rows = std::vector<Row>;

/// Returns the rows as a JSON array of flat objects.
inline std::string json_of(const Rows& rows) {
  api::JsonWriter json;
  json.begin_array();
  for (const Row& row : rows) {
    json.begin_object();
    json.member("part", row.part);
    json.member("case", row.subject);
    json.member("what", row.what);
    json.member("size", row.size);
    json.member("ms", row.ms);
    json.member("triangles", row.triangles);
    json.end_object();
  }
  json.end_array();
  return json.take();
}

}  // namespace remesh::bench
