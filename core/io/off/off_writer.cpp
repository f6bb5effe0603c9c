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

  WriteProgress progress(mesh.positions.size() + mesh.faces.size(), control);
  for (const Vec3& position : mesh.positions) {
    progress.tick();
    std::string_view separator;
    for (const double coordinate : {position.x, position.y, position.z}) {
      out += separator;
      append_real(out, coordinate);
      separator = " ";
    }
    out += '\n';
  }
  for (const Triangle& face : mesh.faces) {
    progress.tick();
    out += '3';
    for (const VertexId v : face) {
      out += ' ';
      append_integer(out, v.value);
    }
    out += '\n';
  }
  // Many readers accept comments in no other place. TetGen and OpenMesh expect the counts directly after the keyword;
  // meshio and TetGen expect the vertices directly after the counts.
  for (const std::string& comment : comments) {
    for (const std::string& line : comment_lines(comment)) out += "# " + line + "\n";
  }
  return out;
}

}  // namespace remesh
