#include "core/io/common/number_parsing.h"
#include "core/io/common/write_text.h"
#include "core/io/off/off.h"

namespace remesh {

std::string write_off(const TriangleMesh& mesh, const std::vector<std::string>& comments, RunControl& control) {
  control.enter(Stage::kWrite);
  std::string out = "OFF\n";
  append_integer(out, mesh.positions.size());
  out += ' ';
  append_integer(out, mesh.faces.size());
  out += " 0\n";

  const double share = share_of_vertices(mesh);
  append_points(out, mesh, share, control);
  append_triangles(out, mesh, share, {}, control);
  // Many readers accept comments in no other place. TetGen and OpenMesh expect the counts directly after the keyword;
  // meshio and TetGen expect the vertices directly after the counts.
  for (const std::string& comment : comments) {
    for (const std::string& line : comment_lines(comment)) out += "# " + line + "\n";
  }
  return out;
}

}  // namespace remesh
