/// Parses a piece of OBJ text independently of the rest.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/base/ids.h"
#include "core/base/vec.h"
#include "core/io/obj/obj_dropped_records.h"

namespace remesh {

/// The content of the lines of a chunk, as far as it is known without the text before them.
struct ObjChunk {
  enum class LabelKind : std::uint8_t { kObject, kGroup, kMaterial };
  /// A record that labels all following faces. `face` is the number of the first such face within the chunk. The name
  /// is a view into the text, unchanged.
  struct Label {
    LabelKind kind;
    std::uint32_t face;
    std::string_view name;
  };

  std::vector<Vec3> positions;
  /// Vertex numbers from 0. Those at the positions in `relative` are 32-bit differences to the number of vertices
  /// before the chunk.
  std::vector<VertexId> corners;
  std::vector<std::uint32_t> relative;
  std::vector<std::uint32_t> face_end;  ///< the ends of the faces in `corners`
  std::uint32_t largest_index = 0;      ///< largest index that is not relative, from 1; 0 if there is none
  std::vector<Label> labels;
  std::vector<std::string_view> material_libraries;
  ObjExtras extras;
};

/// Parses whole lines of plain records.
/// Input:  text whose last character is a line end. The character before its first one must be a line end too. The
///         text must outlive the chunk.
/// Output: nothing if some line is continued, may be continued, or is wrong. It is not checked here that the vertices
///         of faces exist.
/// Cost:   O(text); each byte is read once.
std::optional<ObjChunk> parse_obj_chunk(std::string_view text);

}  // namespace remesh
