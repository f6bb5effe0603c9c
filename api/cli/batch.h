/// A whole folder of meshes, several at once.
#pragma once

#include <string>

#include "api/service.h"
#include "core/base/run_control.h"

namespace remesh::cli {

struct BatchJob {
  std::string folder;         ///< with its folders
  std::string report;         ///< the table to write; `-` for standard output
  std::string output_folder;  ///< empty: the meshes are not written
  api::Fields options;        ///< by the contract's names
  api::Limits limits;         ///< `workers` for all files together
};

struct BatchOutcome {
  std::size_t files = 0;
  std::size_t failed = 0;
};

/// Remeshes every file below the folder whose ending is that of a format that is read, also behind `.gz`, and writes a
/// table of comma-separated values, a line a file, sorted by name: file, status (`ok` or `failed`), code, faces_in,
/// faces_out, patches, kept, min_angle_deg, max_angle_deg, verified, warnings, seconds, message. A file that fails is a
/// line like any other. Until the last one has ended, the table has the lines so far, in the order in which they came
/// about. Shows its progress on standard error, if that is a terminal.
/// Output files have the name of the input, its ending that of their format; two that would be one keep both endings.
/// An output folder inside the folder is not searched.
/// Holds:   but for the seconds, the same bytes for any number of workers; no mesh that is read is written over.
/// Errors:  FileError - the folder cannot be read, the table not be written; remesh::Error kInvalidOption - the output
///          folder is the folder itself, or an output one of its meshes.
BatchOutcome run_batch(const BatchJob& job, RunControl& control);

}  // namespace remesh::cli
