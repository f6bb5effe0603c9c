/// The form in which the result of a job is stored. Any format can be written from it later, with the same bytes that a
/// direct answer to the request would have had.
#pragma once

#include <string>
#include <string_view>

#include "api/summary.h"
#include "core/io/formats.h"
#include "core/remesh.h"

namespace remesh::api {

/// All data that the writers of mesh formats need, except the report.
struct KeptResult {
  Format format = Format::kObj;  ///< the format that the job asked for
  bool local_origin = false;     ///< the option of the job
  Writing writing;               ///< the options of the job
  Summary summary;               ///< describes the result in doubles
  std::string server_timing;
  std::string file_name;  ///< the name of the uploaded file, not trusted
  /// The report on the result in doubles, as JSON. It is empty unless the job's own report describes coordinates that
  /// were rounded for its
  /// format, or names that were changed for it.
  std::string exact_report;
  /// The result in doubles, with its basis. Its report is empty, except for the surfaces of the patches
  /// and the axis that points upwards.
  Result result;
};

/// Packs a result.
/// Holds: unpack(pack(x)) has the same coordinates bit for bit, and all labels.
/// Cost:  O(mesh).
std::string pack_result(const KeptResult& kept);

/// Unpacks a result.
/// Errors: kInternal - the bytes do not come from `pack_result` of this version.
KeptResult unpack_result(std::string_view bytes);

}  // namespace remesh::api
