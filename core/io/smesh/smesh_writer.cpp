#include "core/io/common/enclosed_volumes.h"
#include "core/io/common/number_parsing.h"
#include "core/io/common/write_text.h"
#include "core/io/smesh/smesh.h"

namespace remesh {
namespace {

/// Writes the points in volumes of one kind.
void write_points_inside(std::string& out, const EnclosedVolumes& volumes, const std::vector<Vec3>& points,
                         bool are_solid) {
  std::size_t count = 0;
  std::string lines;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (volumes.all[i].is_solid != are_solid) continue;
    append_integer(lines, ++count);
    lines += ' ';
    append_point(lines, points[i]);
    if (are_solid) {
      lines += ' ';
      append_integer(lines, count);
      lines += " -1";  // without it, TetGen takes the attribute for the largest volume of a tetrahedron
    }
    lines += '\n';
  }
  out += std::to_string(count) + "\n" + lines;
}

}  // namespace

std::string write_smesh(const WriterInput& input, RunControl& control) {
  control.enter(Stage::kWrite);
  const TriangleMesh& mesh = input.mesh;
  const Boundaries boundaries(input, control);
  const EnclosedVolumes volumes = enclosed_volumes(mesh, control);
  const std::vector<Vec3> points = points_inside(mesh, volumes, control);
  std::string out;
  append_comments(out, input.comments);
  append_names(out, "marker", boundaries, control);
  out += "# nodes\n" + std::to_string(mesh.positions.size()) + " 3 0 0\n";
  const double share = share_of_vertices(mesh);
  append_elements(out, mesh.positions.size(), {0, share}, control, [&](std::string& text, std::size_t v) {
    append_integer(text, v + 1);
    append_coordinates(text, mesh.positions[VertexId(v)]);
  });
  out += "# facets\n" + std::to_string(mesh.faces.size()) + " 1\n";
  append_elements(out, mesh.faces.size(), {share, 1}, control, [&](std::string& text, std::size_t i) {
    const FaceId f(i);
    text += '3';
    for (const VertexId v : mesh.faces[f]) {
      text += ' ';
      append_integer(text, std::uint64_t{v.value} + 1);
    }
    text += ' ';
    append_integer(text, std::uint64_t{boundaries.of(f)} + 1);
    text += '\n';
  });
  out += "# holes\n";
  write_points_inside(out, volumes, points, /*are_solid=*/false);
  out += "# regions\n";
  write_points_inside(out, volumes, points, /*are_solid=*/true);
  return out;
}

}  // namespace remesh
