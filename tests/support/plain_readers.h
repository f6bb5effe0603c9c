/// Readers of the files that this project writes. They share no code with the project's readers: they use strtod and
/// split text into words. They accept well-formed files only.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/base/vec.h"
#include "core/io/formats.h"

namespace remesh::test {

/// The triangles of a file in their order, each by the positions of its corners. For binary STL these are the numbers
/// in the file.
struct PlainMesh {
  std::vector<std::array<Vec3, 3>> triangles;
  std::vector<std::string> solid_of;  ///< the name of each triangle's solid, for text STL
};

/// Reads all formats except JSON. The test fails if the file does not follow its format.
PlainMesh read_plainly(Format format, const std::string& file);

}  // namespace remesh::test
