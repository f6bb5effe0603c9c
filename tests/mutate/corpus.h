/// The meshes that cases are made from.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/io/formats.h"

namespace remesh::mutate {

struct CorpusFile {
  std::string name;   ///< within its folder; of a mesh that is made here, in angle brackets
  std::string bytes;  ///< not compressed
  Format format = Format::kObj;
};

/// Loads the project's own meshes, those of the collection beside it where that is there, and some that are made here.
/// Output:  files of at most `max_bytes`, the small ones first; of equal sizes by name.
/// Holds:   no thread is started, so that the caller may fork.
std::vector<CorpusFile> load_corpus(std::size_t max_bytes);

}  // namespace remesh::mutate
