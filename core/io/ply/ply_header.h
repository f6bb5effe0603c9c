/// Parses the header of a PLY file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace remesh {

enum class PlyEncoding { kText, kLittleEndian, kBigEndian };
enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

constexpr bool is_real(PlyType type) { return type == PlyType::kFloat32 || type == PlyType::kFloat64; }
constexpr std::size_t size_of(PlyType type) {
  switch (type) {
    case PlyType::kInt8:
    case PlyType::kUint8: return 1;
    case PlyType::kInt16:
    case PlyType::kUint16: return 2;
    case PlyType::kInt32:
    case PlyType::kUint32:
    case PlyType::kFloat32: return 4;
    case PlyType::kFloat64: return 8;
  }
  return 0;
}

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kInt8;
  std::optional<PlyType> count_type;  ///< type of the count, if the property is a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;  ///< one or more if count > 0
  std::uint64_t line = 0;               ///< the line of its declaration

  /// The smallest size of a record in bytes, which it has if its lists are empty.
  std::size_t least_size() const;
  bool has_lists() const;
  /// The index of the property of that name.
  /// Output: nothing if there is none.
  std::optional<std::size_t> find(std::string_view property) const;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kText;
  std::vector<PlyElement> elements;
  std::vector<std::string> comments;  ///< the text after the word `comment` and a blank
  std::size_t size = 0;               ///< bytes, including the end of the last line
  std::uint64_t lines = 0;
};

/// Parses the header of a PLY file.
/// Errors: kInvalidMesh, with the line - not a PLY header.
/// Cost:   O(header).
PlyHeader parse_ply_header(std::string_view content);

}  // namespace remesh
