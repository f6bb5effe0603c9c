/// A mesh that anything may be done to: plain lists, no promise kept, and its text.
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
/// The format that a reader of such text is asked for.
Format format_of(SoupFormat format);

PolygonSoup soup_of(const PolygonMesh& mesh);

/// Writes all digits. What a format cannot hold is written as far as it can: STL gets fans of polygons, and no labels.
std::string write_soup(const PolygonSoup& soup, SoupFormat format);

}  // namespace remesh::mutate
