/// Collects the surface of a model for finite elements.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/run_control.h"
#include "core/io/common/format.h"
#include "core/io/common/mesh_builder.h"
#include "core/io/common/node_tags.h"
#include "core/io/common/read_errors.h"

namespace remesh {

/// Collects nodes and faces in any order, since faces may come before their nodes.
class FeSurface {
 public:
  FeSurface(std::string_view content, const ReadLimits& limits, RunControl& control)
      : content_(content), limits_(limits), control_(control), builder_(limits, control) {}

  /// Errors: kMeshTooLarge - more than the limits.
  void add_node(std::uint64_t tag, const Vec3& position, std::uint64_t line);
  /// Adds a face with three or four corners, which are tags of nodes.
  void add_face(std::uint64_t tag, std::span<const std::uint64_t> corners, std::uint64_t line);
  /// Counts an element that is no face.
  void drop(std::string_view kind);

  std::size_t face_count() const { return faces_.size(); }
  /// Finds faces by their tags, once all are there.
  /// Errors: kInvalidMesh - two faces have the same tag.
  const NodeTags& sorted_faces();
  /// Must be called for each line; checks for cancellation from time to time.
  void tick(std::size_t offset) { builder_.tick(offset, content_.size()); }

  /// Makes the mesh, and the diagnostics of what was dropped.
  ReadResult take();

 private:
  struct Face {
    std::array<std::uint64_t, 4> corners;  ///< the last one is 0 in a triangle
    std::uint64_t line;
  };

  std::string_view content_;
  const ReadLimits& limits_;
  RunControl& control_;
  MeshBuilder builder_;
  std::uint64_t last_line_ = 1;  ///< of a node or a face, for errors that concern several
  std::vector<Vec3> positions_;
  NodeTags nodes_, face_tags_;
  std::vector<Face> faces_;
  std::map<std::string, std::uint64_t, std::less<>> dropped_;
};

/// Parses the number of a node, an element or a property.
/// Errors: kInvalidMesh - it is none from 1 to 2^31.
std::uint64_t parse_tag(std::string_view token, const char* what, std::uint64_t line);

/// Parses a coordinate as Fortran writes it: also `1.5D0` and `1.5-3`. An empty one is 0.
double parse_fortran_coordinate(std::string_view token, std::uint64_t line);

}  // namespace remesh
