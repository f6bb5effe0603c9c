/// A piece of OBJ text, parsed on its own.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/base/ids.h"
#include "core/base/vec.h"
#include "core/io/obj_dropped_records.h"

namespace remesh {

/// What the lines of a chunk say without knowing what comes before them.
struct ObjChunk {
  enum class LabelKind : std::uint8_t { kObject, kGroup, kMaterial };
  /// A record that labels the faces from `face` on, counted in the chunk. The name is a view into the text, as it
  /// stands.
  struct Label {
    LabelKind kind;
    std::uint32_t face;
    std::string_view name;
  };

  std::vector<Vec3> positions;
  /// Vertex numbers from 0; those listed in `relative` are 32-bit differences to the number of vertices before the
  /// chunk.
  std::vector<VertexId> corners;
  std::vector<std::uint32_t> relative;
  std::vector<std::uint32_t> face_end;  ///< in `corners`
  std::uint32_t largest_index = 0;      ///< of those that are not relative, from 1; 0 without any
  std::vector<Label> labels;
  std::vector<std::string_view> material_libraries;
  ObjFindings findings;
};

/// Parses whole lines of plain records.
/// Input:  text whose last character is a line end, and the one before its first one, too; it outlives the chunk.
/// Output: nothing if some line is continued, might be, or is wrong. Whether the vertices of faces exist is left open.
/// Cost:   O(text), one look at each byte.
std::optional<ObjChunk> parse_obj_chunk(std::string_view text);

}  // namespace remesh
