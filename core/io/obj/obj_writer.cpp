#include <algorithm>
#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/io/common/number_parsing.h"
#include "core/io/common/write_text.h"
#include "core/io/obj/obj.h"

namespace remesh {
namespace {

/// The length of a vertex line: `v`, three numbers of at most 24 characters with a blank each, and the line end.
constexpr std::size_t kMaxVertexLine = 1 + 3 * 25 + 1;

std::size_t digit_count(std::size_t n) {
  std::size_t digits = 1;
  for (; n >= 10; n /= 10) ++digits;
  return digits;
}

/// Writes a record that contains free text. The text cannot end the record or continue it on the next line.
void append_free_text(std::string& out, std::string_view keyword, std::string_view text) {
  out += keyword;
  if (!text.empty()) out += ' ';
  out += without_control_characters(text);
  if (text.ends_with('\\')) out += ' ';  // a backslash would continue the line
  out += '\n';
}

/// Writes a record if the label changes from the previous face to this one.
void append_label(std::string& out, std::string_view keyword, const LabelSet& labels, FaceId f) {
  if (!labels.is_used()) return;
  const std::uint32_t label = labels.of_face[f];
  if (f.value > 0 && label == labels.of_face[FaceId(f.value - 1)]) return;
  append_free_text(out, keyword, labels.names[label]);
}

void append_face(std::string& out, const TriangleMesh& mesh, FaceId f) {
  append_label(out, "o", mesh.labels.object, f);
  append_label(out, "g", mesh.labels.group, f);
  append_label(out, "usemtl", mesh.labels.material, f);
  char line[3 * 21 + 2] = {'f'};
  char* at = line + 1;
  for (const VertexId v : mesh.faces[f]) {
    *at++ = ' ';
    at = std::to_chars(at, line + sizeof line, std::uint64_t{v.value} + 1).ptr;
  }
  *at++ = '\n';
  out.append(line, at);
}

}  // namespace

std::string write_obj(const TriangleMesh& mesh, const std::vector<std::string>& comments, RunControl& control) {
  control.enter(Stage::kWrite);
  const std::size_t vertices = mesh.positions.size();
  const std::size_t faces = mesh.faces.size();
  std::string out;
  // This is an upper bound, apart from names and comments. Memory that is not written to costs nothing, but moving
  // the text would.
  out.reserve(vertices * kMaxVertexLine + faces * (2 + 3 * (1 + digit_count(vertices))));
  for (const std::string& comment : comments) {
    for (const std::string& line : comment_lines(comment)) append_free_text(out, "#", line);
  }
  for (const std::string& files : mesh.labels.material_libraries) append_free_text(out, "mtllib", files);

  const double share = share_of_vertices(mesh);
  append_elements(out, vertices, {0, share}, control, [&](std::string& text, std::size_t v) {
    text += 'v';
    append_coordinates(text, mesh.positions[VertexId(v)]);
  });
  append_elements(out, faces, {share, 1}, control,
                  [&](std::string& text, std::size_t f) { append_face(text, mesh, FaceId(f)); });
  return out;
}

}  // namespace remesh
