/// A remeshed surface as bytes to keep: any format can be written from it later, with the bytes that the job itself
/// would have written.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "api/summary.h"
#include "core/io/formats.h"
#include "core/remesh.h"

namespace remesh::api {

/// All that the writers of mesh formats need, but for the report.
struct KeptResult {
  Format format = Format::kObj;  ///< that the job asked for
  bool local_origin = false;     ///< as the job asked for
  Summary summary;               ///< of the result in doubles
  std::string server_timing;
  std::string file_name;  ///< of the upload, not trusted
  /// The report on the result in doubles, as JSON, where the job's own report is about another format's numbers.
  std::string exact_report;
  Result result;  ///< in doubles, with its basis; its report is empty
};

/// Holds: unpack(pack(x)) has the same coordinates bit for bit, and all labels.
/// Cost:  O(mesh).
std::string pack_result(const KeptResult& kept);

/// Errors: kInternal - the bytes are not what `pack_result` of this version gave.
KeptResult unpack_result(std::string_view bytes);

}  // namespace remesh::api
