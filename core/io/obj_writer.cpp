#include <array>
#include <cstdint>
#include <string>

#include "core/io/obj.h"
#include "core/io/text.h"

namespace remesh {
namespace {

/// Elements between two looks at the control.
constexpr std::size_t kProgressStep = 1 << 16;
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
  for (const char c : text) out += is_control_character(c) ? ' ' : c;
  if (text.ends_with('\\')) out += ' ';  // else it would continue the line
  out += '\n';
}

void append_comment(std::string& out, std::string_view comment) {
  for (;;) {
    const std::size_t line_end = comment.find_first_of("\r\n");
    append_free_text(out, "#", comment.substr(0, line_end));
    if (line_end == std::string_view::npos) return;
    comment.remove_prefix(line_end + (comment.substr(line_end, 2) == "\r\n" ? 2 : 1));
  }
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
  const auto report_progress = [&](std::size_t done) {
    if (done % kProgressStep == 0) control.progress(static_cast<double>(done) / static_cast<double>(vertices + faces));
  };

  std::string out;
  // An upper bound but for names and comments: memory that is not written to costs nothing, moving the text would.
  out.reserve(vertices * kMaxVertexLine + faces * (2 + 3 * (1 + digit_count(vertices))));
  for (const std::string& comment : comments) append_comment(out, comment);
  for (const std::string& files : mesh.labels.material_libraries) append_free_text(out, "mtllib", files);

  std::size_t done = 0;
  for (const Vec3& position : mesh.positions) {
    report_progress(done++);
    out += 'v';
    for (const double coordinate : {position.x, position.y, position.z}) {
      out += ' ';
      append_real(out, coordinate);
    }
    out += '\n';
  }

  std::array<LabelWriter, 3> label_writers{LabelWriter("o", mesh.labels.object), LabelWriter("g", mesh.labels.group),
                                           LabelWriter("usemtl", mesh.labels.material)};
  FaceId f(0);
  for (const Triangle& triangle : mesh.faces) {
    report_progress(done++);
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
