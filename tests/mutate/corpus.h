/// Loads the meshes from which cases are made.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/io/formats.h"

namespace remesh::mutate {

struct CorpusFile {
  std::string name;   ///< the path within its folder; for a mesh that is made here, a name in angle brackets
  std::string bytes;  ///< not compressed
  Format format = Format::kObj;
};

/// Loads the project's own meshes, those of the collection beside it if that exists, and some that are made here.
/// Output:  files of at most `max_bytes`, sorted by size and then by name.
/// Holds:   no thread is started, so that the caller may fork.
/// Errors:  std::runtime_error - the collection is missing, and REMESHD_REQUIRE_CORPUS is 1.
std::vector<CorpusFile> load_corpus(std::size_t max_bytes);

}  // namespace remesh::mutate
