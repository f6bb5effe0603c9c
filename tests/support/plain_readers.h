/// Readers of what this project writes that share nothing with its own: by strtod, by fields, word by word. They take
/// nothing but well-formed files.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/base/vec.h"
#include "core/io/formats.h"

namespace remesh::test {

/// The triangles of a file in their order, each by the places of its corners. Of binary STL the numbers in the file.
struct PlainMesh {
  std::vector<std::array<Vec3, 3>> triangles;
  std::vector<std::string> solid_of;  ///< text STL: the name of each triangle's solid
};

/// All formats but JSON. Fails the test where the file is not what its format says.
PlainMesh read_plainly(Format format, const std::string& file);

}  // namespace remesh::test
