/// Reads written meshes back with readers that share no code with the project's.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/vec.h"
#include "core/io/formats.h"

namespace remesh::test {

struct WrittenMesh {
  std::vector<Vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> faces;
  bool has_floats = false;            ///< coordinates are floats instead of doubles
  bool has_own_vertices = true;       ///< false: every face has its own corners (STL)
  std::vector<std::string> solid_of;  ///< the name of each face's solid, for text STL
};

/// Reads a mesh.
/// Errors: std::runtime_error - the bytes do not follow the format, an index is out of range, or a coordinate is not
///         finite.
WrittenMesh read_written(Format format, const std::string& bytes);

/// Checks that the text is JSON and that every number in it is finite.
/// Errors: std::runtime_error.
void expect_finite_json(const std::string& text);

}  // namespace remesh::test
