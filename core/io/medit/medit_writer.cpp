#include "core/io/common/number_parsing.h"
#include "core/io/common/write_text.h"
#include "core/io/medit/medit.h"

namespace remesh {

std::string write_medit(const WriterInput& input, RunControl& control) {
  control.enter(Stage::kWrite);
  const TriangleMesh& mesh = input.mesh;
  const Boundaries boundaries(input, control);
  // Readers look for the first two keywords without regard to comments.
  std::string out = "MeshVersionFormatted 2\nDimension 3\n";
  append_comments(out, input.comments);
  append_names(out, "reference", boundaries, control);
  out += "Vertices\n" + std::to_string(mesh.positions.size()) + "\n";
  const double share = share_of_vertices(mesh);
  append_elements(out, mesh.positions.size(), {0, share}, control, [&](std::string& text, std::size_t v) {
    append_point(text, mesh.positions[VertexId(v)]);
    text += " 0\n";
  });
  out += "Triangles\n" + std::to_string(mesh.faces.size()) + "\n";
  append_elements(out, mesh.faces.size(), {share, 1}, control, [&](std::string& text, std::size_t i) {
    const FaceId f(i);
    for (const VertexId v : mesh.faces[f]) {
      append_integer(text, std::uint64_t{v.value} + 1);
      text += ' ';
    }
    append_integer(text, std::uint64_t{boundaries.of(f)} + 1);
    text += '\n';
  });
  return out + "End\n";
}

}  // namespace remesh
