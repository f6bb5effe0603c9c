#include "core/io/vtu/vtk_mesh.h"

#include <algorithm>
#include <utility>

#include "core/io/common/label_collector.h"

namespace remesh {
namespace {

/// VTK's types of cells that are faces. All of higher order have their corners first.
enum VtkType { kVtkTriangle = 5, kVtkStrip = 6, kVtkPolygon = 7, kVtkPixel = 8, kVtkQuad = 9 };

/// The number of corners of a face of higher order; 0: it is none.
std::size_t corners_of_type(int type) {
  switch (type) {
    case 22:            // quadratic triangle
    case 34:            // biquadratic triangle
    case 69:            // Lagrange triangle
    case 76: return 3;  // Bezier triangle
    case 23:            // quadratic quadrilateral
    case 28:            // biquadratic quadrilateral
    case 30:            // quadratic and linear quadrilateral
    case 70:            // Lagrange quadrilateral
    case 77: return 4;  // Bezier quadrilateral
    default: return 0;
  }
}

}  // namespace

std::optional<VtkMesh::Kind> VtkMesh::kind_of(std::string_view array) {
  if (array == "object") return Kind::kObject;
  if (array == "group" || array == "gmsh:physical" || array == "medit:ref") return Kind::kGroup;
  if (array == "material") return Kind::kMaterial;
  return std::nullopt;
}

void VtkMesh::begin_piece(std::uint64_t points, std::uint64_t room, Place place) {
  if (points > limits_.max_vertices - points_) throw too_large_error(place, "vertices", limits_.max_vertices);
  points_before_ = points_;
  points_ += points;
  // Memory is reserved for the first piece only: to reserve it for each piece would move all earlier vertices.
  builder_.announce(points_, 0, points_before_ == 0 ? room : 0, 0, place);
}

void VtkMesh::expect_cells(std::size_t cells, std::size_t corners) {
  // Memory is reserved for the first piece only: to reserve it for each piece would move all earlier faces.
  if (points_before_ > 0) return;
  PolygonMesh& mesh = builder_.mesh();
  mesh.face_begin.reserve(mesh.face_begin.size() + cells);
  mesh.corners.reserve(mesh.corners.size() + corners);
  cell_of_face_.reserve(cells);
}

void VtkMesh::add_cell(int type, std::span<const std::int64_t> points, Place place) {
  const std::size_t n = points.size();
  if (type == kVtkTriangle || type == kVtkQuad || type == kVtkPolygon) {
    add_face(points, place);
  } else if (type == kVtkStrip) {
    for (std::size_t i = 0; i + 2 < n; ++i)
      add_face(std::array{points[i], points[i + 1 + i % 2], points[i + 2 - i % 2]}, place);
  } else if (type == kVtkPixel && n == 4) {
    add_face(std::array{points[0], points[1], points[3], points[2]}, place);
  } else if (const std::size_t corners = corners_of_type(type); corners > 0 && n > corners) {
    ++curved_;
    add_face(points.first(corners), place);
  } else {
    ++other_cells_;
  }
  ++cells_;
}

void VtkMesh::add_face(std::span<const std::int64_t> points, Place place) {
  if (builder_.mesh().face_count() == limits_.max_faces) throw too_large_error(place, "faces", limits_.max_faces);
  builder_.begin_face(points.size(), place);
  const auto before = static_cast<std::int64_t>(points_before_), in_piece = static_cast<std::int64_t>(points_) - before;
  for (const std::int64_t point : points) {
    const bool is_there = point >= 0 && point < in_piece;
    builder_.add_corner(is_there ? before + point : -1, place);
  }
  cell_of_face_.push_back(cells_);
}

void VtkMesh::end_piece(const std::array<std::vector<std::int64_t>, 3>& labels_of_cells) {
  for (std::size_t kind = 0; kind < labels_.size(); ++kind) {
    const std::vector<std::int64_t>& label_of = labels_of_cells[kind];
    if (label_of.empty()) labels_[kind].add_faces(0, cell_of_face_.size());
    if (label_of.empty()) continue;
    for (const std::uint32_t cell : cell_of_face_) labels_[kind].add_face(label_of[cell]);
  }
  cell_of_face_.clear();
  cells_ = 0;
}

void VtkMesh::add_name(Kind kind, std::int64_t number, std::string name) {
  if (name.size() <= kMaxNameLength) names_[static_cast<std::size_t>(kind)].try_emplace(number, std::move(name));
}

ReadResult VtkMesh::take() {
  ReadResult result;
  result.mesh = builder_.take();
  FaceLabels& labels = result.mesh.labels;
  LabelSet* const sets[] = {&labels.object, &labels.group, &labels.material};
  for (std::size_t kind = 0; kind < labels_.size(); ++kind) *sets[kind] = labels_[kind].take(names_[kind]);
  record_dropped("cells that are no faces were dropped", other_cells_, result.diagnostics);
  record_dropped("points on the edges of faces were dropped; number of faces that had them", curved_,
                 result.diagnostics);
  record_dropped("arrays of values at points or cells were dropped", dropped_arrays_, result.diagnostics);
  return result;
}

}  // namespace remesh
