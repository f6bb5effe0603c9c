/// Builds a mesh of VTK's cells. It is shared by the readers of VTK's formats.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/io/common/bytes.h"
#include "core/io/common/mesh_builder.h"
#include "core/io/common/numbered_labels.h"

namespace remesh {

/// Reads as many numbers as there are values, which are stored as another type.
template <class Stored, class T>
void load_numbers(const char* bytes, ByteOrder order, std::vector<T>& values) {
  load_all<Stored>(bytes, order, values.size(), [&](std::size_t i, Stored value) {
    if constexpr (std::is_floating_point_v<Stored> && !std::is_floating_point_v<T>) {
      // A label may be stored as a real number.
      values[i] = value > -0x1p53 && value < 0x1p53 ? static_cast<T>(value) : 0;
    } else {
      values[i] = static_cast<T>(value);
    }
  });
}

/// Collects points and cells, piece after piece. Cells that are no faces are counted and left out.
class VtkMesh {
 public:
  enum class Kind { kObject, kGroup, kMaterial };
  /// The kind of labels that are in an array of cell data with this name: `object`, `group`, `material` as remeshd
  /// writes them, `gmsh:physical` and `medit:ref` as meshio does.
  static std::optional<Kind> kind_of(std::string_view array);

  VtkMesh(std::string_view content, const ReadLimits& limits, RunControl& control)
      : content_(content), limits_(limits), builder_(limits, control) {}

  /// Begins a piece with so many points.
  /// Input:  `room` - how many points the file's length permits at most.
  /// Errors: kMeshTooLarge - more points than the limits.
  void begin_piece(std::uint64_t points, std::uint64_t room, Place place);
  void add_point(const Vec3& point, Place place) { builder_.add_vertex(point, place); }
  /// Makes room for faces. Input: the numbers of cells that follow and of their corners, which are in memory already.
  void expect_cells(std::size_t cells, std::size_t corners);
  /// Adds a cell by VTK's number of its type. Strips of triangles become triangles.
  /// Errors: kIndexOutOfRange, kInvalidMesh, kMeshTooLarge.
  void add_cell(int type, std::span<const std::int64_t> points, Place place);
  /// Ends the piece.
  /// Input:  the labels of its cells by kind; empty if it has none of that kind.
  void end_piece(const std::array<std::vector<std::int64_t>, 3>& labels_of_cells);

  void add_name(Kind kind, std::int64_t number, std::string name);
  void drop_array() { ++dropped_arrays_; }
  /// The largest number of corners that all cells of a piece may have. It bounds the memory for packed arrays.
  std::uint64_t max_corners() const { return 8 * (limits_.max_faces + limits_.max_vertices); }
  void tick(std::size_t offset) { builder_.tick(offset, content_.size()); }

  ReadResult take();

 private:
  void add_face(std::span<const std::int64_t> points, Place place);

  std::string_view content_;
  const ReadLimits& limits_;
  MeshBuilder builder_;
  std::array<NumberedLabels, 3> labels_;
  std::array<NumberedLabels::Names, 3> names_;
  std::vector<std::uint32_t> cell_of_face_;  ///< the number of the cell of each face of the piece
  std::uint64_t points_ = 0;                 ///< in all pieces so far
  std::uint64_t points_before_ = 0;          ///< in the pieces before this one
  std::uint32_t cells_ = 0;                  ///< in this piece so far
  std::uint64_t other_cells_ = 0, curved_ = 0, dropped_arrays_ = 0;
};

/// Reads VTK's XML formats.
ReadResult read_vtk_xml(std::string_view content, const ReadLimits& limits, RunControl& control);
/// Reads VTK's legacy format.
ReadResult read_vtk_legacy(std::string_view content, const ReadLimits& limits, RunControl& control);

}  // namespace remesh
