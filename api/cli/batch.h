/// Remeshes all meshes in a folder, several at once.
#pragma once

#include <string>

#include "api/operations.h"
#include "core/base/run_control.h"

namespace remesh::cli {

struct BatchJob {
  std::string folder;         ///< searched with its subfolders
  std::string report;         ///< the table to write; `-` for standard output
  std::string output_folder;  ///< empty: no meshes are written
  api::Fields options;        ///< options by their names in the API
  api::Limits limits;         ///< `workers` applies to all files together
  bool is_quiet = false;      ///< no progress is shown
};

struct BatchOutcome {
  std::size_t files = 0;
  std::size_t failed = 0;
};

/// Remeshes every file below the folder whose ending belongs to a format that can be read, also in front of `.gz`. It
/// writes a table of comma-separated values with one line for each file, sorted by name: file, status (`ok` or
/// `failed`), code, faces_in, faces_out, patches, kept, min_angle_deg, max_angle_deg, verified, warnings, seconds,
/// message. A file that fails is a line like any other. Until the last file has ended, the table has the lines so
/// far, in the order in which the files ended. Progress is shown on standard error if that is a terminal.
/// An output file has the name of its input with the ending of its own format. If two outputs would have the same
/// name, both endings stay in it. An output folder inside the input folder is not searched.
/// Holds:   except for the seconds, the bytes do not depend on the number of workers; no input mesh is overwritten.
/// Errors:  FileError - the folder cannot be read, or the table cannot be written; remesh::Error kInvalidOption - the
///          output folder is the input folder itself, or an output would overwrite one of the meshes.
BatchOutcome run_batch(const BatchJob& job, RunControl& control);

}  // namespace remesh::cli
