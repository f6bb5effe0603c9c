/// A remeshed surface as bytes to keep: any format can be written from it later, with the bytes that the job itself
/// would have written.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/io/formats.h"
#include "core/remesh.h"

namespace remesh::api {

/// All that the writers of mesh formats need, but for the report.
struct KeptResult {
  Format format = Format::kObj;  ///< that the job asked for
  std::string summary;           ///< see remesh_summary
  std::string server_timing;
  std::string file_name;  ///< of the upload, not trusted
  std::vector<std::string> comments;
  Result result;  ///< its report is empty
};

/// Holds: unpack(pack(x)) has the same coordinates bit for bit, and all labels.
/// Cost:  O(mesh).
std::string pack_result(const KeptResult& kept);

/// Errors: kInternal - the bytes are not what `pack_result` of this version gave.
KeptResult unpack_result(std::string_view bytes);

}  // namespace remesh::api
