#include <array>
#include <cstdint>
#include <string>

#include "core/io/obj.h"
#include "core/io/text.h"
#include "core/io/write_text.h"

namespace remesh {
namespace {

/// `v` and three numbers of at most 24 characters, with blanks and the line end.
constexpr std::size_t kMaxVertexLine = 1 + 3 * 25 + 1;

std::size_t digit_count(std::size_t n) {
  std::size_t digits = 1;
  for (; n >= 10; n /= 10) ++digits;
  return digits;
}

/// Writes a record with free text in it, such that the text cannot end the record or run on into the next one.
void append_free_text(std::string& out, std::string_view keyword, std::string_view text) {
  out += keyword;
  if (!text.empty()) out += ' ';
  out += without_control_characters(text);
  if (text.ends_with('\\')) out += ' ';  // else it would continue the line
  out += '\n';
}

/// Writes a record of one kind where the label changes from one face to the next.
class LabelWriter {
 public:
  LabelWriter(std::string_view keyword, const LabelSet& labels) : keyword_(keyword), labels_(labels) {}

  void write(std::string& out, FaceId f) {
    if (!labels_.is_used()) return;
    const std::uint32_t label = labels_.of_face[f];
    if (f.value > 0 && label == current_) return;
    current_ = label;
    append_free_text(out, keyword_, labels_.names[label]);
  }

 private:
  std::string_view keyword_;
  const LabelSet& labels_;
  std::uint32_t current_ = 0;
};

}  // namespace

std::string write_obj(const TriangleMesh& mesh, const std::vector<std::string>& comments, RunControl& control) {
  control.enter(Stage::kWrite);
  const std::size_t vertices = mesh.positions.size();
  const std::size_t faces = mesh.faces.size();
  std::string out;
  // An upper bound but for names and comments: memory that is not written to costs nothing, moving the text would.
  out.reserve(vertices * kMaxVertexLine + faces * (2 + 3 * (1 + digit_count(vertices))));
  for (const std::string& comment : comments) {
    for (const std::string& line : comment_lines(comment)) append_free_text(out, "#", line);
  }
  for (const std::string& files : mesh.labels.material_libraries) append_free_text(out, "mtllib", files);

  WriteProgress progress(vertices + faces, control);
  for (const Vec3& position : mesh.positions) {
    progress.tick();
    out += 'v';
    append_coordinates(out, position);
  }

  std::array<LabelWriter, 3> label_writers{LabelWriter("o", mesh.labels.object), LabelWriter("g", mesh.labels.group),
                                           LabelWriter("usemtl", mesh.labels.material)};
  FaceId f(0);
  for (const Triangle& triangle : mesh.faces) {
    progress.tick();
    for (LabelWriter& labels : label_writers) labels.write(out, f);
    out += 'f';
    for (const VertexId v : triangle) {
      out += ' ';
      append_integer(out, std::uint64_t{v.value} + 1);
    }
    out += '\n';
    ++f.value;
  }
  return out;
}

}  // namespace remesh
