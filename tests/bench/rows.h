/// What remesh_bench measured, for scripts.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "api/json_writer.h"

namespace remesh::bench {

/// One figure: what it took to do `what` with a `subject` of this size.
struct Row {
  std::string part;  ///< of remesh_bench
  std::string subject;
  std::string what;
  std::uint64_t size = 0;
  double ms = 0;                ///< a median
  std::uint64_t triangles = 0;  ///< that were made; 0 where they are not counted
};
using Rows = std::vector<Row>;

/// A list of flat objects.
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
