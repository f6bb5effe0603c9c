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

const LabelSet* dividing_labels(const FaceLabels& labels) {
  for (const LabelSet* set : {&labels.group, &labels.object, &labels.material}) {
    if (set->is_used()) return set;
  }
  return nullptr;
}

void append_coordinates(std::string& out, const Vec3& position) {
  char line[3 * 32 + 1];  // the longest number has 24 characters: -2.2250738585072014e-308
  char* at = line;
  for (const double coordinate : {position.x, position.y, position.z}) {
    *at++ = ' ';
    at = std::to_chars(at, line + sizeof line, coordinate).ptr;
  }
  *at++ = '\n';
  out.append(line, at);
}

}  // namespace remesh
