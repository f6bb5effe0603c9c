/// A mesh of plain lists without any invariant, which may be changed in any way, and its text.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/io/formats.h"
#include "core/mesh/mesh.h"

namespace remesh::mutate {

struct PolygonSoup {
  std::vector<Vec3> positions;
  std::vector<std::vector<std::uint32_t>> faces;
  std::vector<std::uint32_t> groups;  ///< one per face, or empty
};

enum class SoupFormat { kObj, kOff, kStlText, kStlBinary, kPlyText, kPlyBinary, kJson };
inline constexpr int kSoupFormatCount = 7;
/// Returns the format to read such text with.
Format format_of(SoupFormat format);

PolygonSoup soup_of(const PolygonMesh& mesh);

/// Writes a soup with all digits. If a format cannot represent something, it is written as far as possible: STL gets
/// fans of polygons, and no labels.
std::string write_soup(const PolygonSoup& soup, SoupFormat format);

}  // namespace remesh::mutate
