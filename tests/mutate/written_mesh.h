/// Reads written meshes back with readers that share no code with the project's.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/vec.h"
#include "core/io/formats.h"

namespace remesh::mutate {

struct WrittenMesh {
  std::vector<Vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> faces;
  bool has_floats = false;       ///< coordinates are floats instead of doubles
  bool has_own_vertices = true;  ///< false: every face has its own corners (STL)
};

/// Reads a mesh.
/// Output: nothing if the format cannot be read here.
/// Errors: std::runtime_error - the bytes do not follow the format, an index is out of range, or a coordinate is not
///         finite.
std::optional<WrittenMesh> read_written(Format format, const std::string& bytes);

/// Checks that the text is JSON and that every number in it is finite.
/// Errors: std::runtime_error.
void expect_finite_json(const std::string& text);

}  // namespace remesh::mutate
