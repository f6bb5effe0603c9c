#include "core/io/common/write_text.h"

#include <charconv>

#include "core/io/common/number_parsing.h"

namespace remesh {

std::vector<std::string> comment_lines(std::string_view comment) {
  std::vector<std::string> lines;
  for (;;) {
    const std::size_t line_end = comment.find_first_of("\r\n");
    lines.push_back(without_control_characters(comment.substr(0, line_end)));
    if (line_end == std::string_view::npos) return lines;
    comment.remove_prefix(line_end + (comment.substr(line_end, 2) == "\r\n" ? 2 : 1));
  }
}

std::string without_control_characters(std::string_view text) {
  std::string clean(text);
  std::replace_if(clean.begin(), clean.end(), is_control_character, ' ');
  return clean;
}

void append_comments(std::string& out, const std::vector<std::string>& comments) {
  constexpr std::size_t kLongest = 200;
  for (const std::string& comment : comments) {
    for (const std::string& line : comment_lines(comment)) {
      std::string_view rest = line;
      do {
        const std::string_view piece = rest.substr(0, kLongest);
        out.append("# ").append(piece).append("\n");
        rest.remove_prefix(piece.size());
      } while (!rest.empty());
    }
  }
}

void append_point(std::string& out, const Vec3& position) {
  char text[3 * 32];  // the longest number has 24 characters: -2.2250738585072014e-308
  char* const end = text + sizeof text;
  char* at = std::to_chars(text, end, position.x).ptr;
  *at++ = ' ';
  at = std::to_chars(at, end, position.y).ptr;
  *at++ = ' ';
  out.append(text, std::to_chars(at, end, position.z).ptr);
}

void append_points(std::string& out, const TriangleMesh& mesh, double share, RunControl& control) {
  append_elements(out, mesh.positions.size(), {0, share}, control, [&](std::string& text, std::size_t v) {
    append_point(text, mesh.positions[VertexId(v)]);
    text += '\n';
  });
}

void append_triangles(std::string& out, const TriangleMesh& mesh, double share,
                      std::span<const LabelSet* const> label_sets, RunControl& control) {
  append_elements(out, mesh.faces.size(), {share, 1}, control, [&](std::string& text, std::size_t f) {
    text += '3';
    const auto append = [&](std::uint32_t number) {
      text += ' ';
      append_integer(text, number);
    };
    for (const VertexId v : mesh.faces[FaceId(f)]) append(v.value);
    for (const LabelSet* set : label_sets) append(set->of_face[FaceId(f)]);
    text += '\n';
  });
}

void append_coordinates(std::string& out, const Vec3& position) {
  out += ' ';
  append_point(out, position);
  out += '\n';
}

}  // namespace remesh
