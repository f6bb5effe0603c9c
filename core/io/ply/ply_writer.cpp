#include <array>
#include <utility>

#include "core/io/common/bytes.h"
#include "core/io/common/number_parsing.h"
#include "core/io/common/write_text.h"
#include "core/io/ply/ply.h"

namespace remesh {
namespace {

/// Writes the header.
/// Output: the labels that each face has.
std::vector<const LabelSet*> write_ply_header(std::string& out, std::string_view encoding, const TriangleMesh& mesh,
                                              const std::vector<std::string>& comments) {
  const FaceLabels& labels = mesh.labels;
  const std::array<std::pair<std::string, const LabelSet*>, 3> kinds{
      {{"object", &labels.object}, {"group", &labels.group}, {"material", &labels.material}}};
  out.append("ply\nformat ").append(encoding).append(" 1.0\n");
  for (const std::string& comment : comments) {
    for (const std::string& line : comment_lines(comment)) out += "comment " + line + "\n";
  }
  for (const auto& [kind, set] : kinds) {
    if (!set->is_used()) continue;
    for (std::size_t i = 0; i < set->names.size(); ++i) {
      out += "comment " + kind + " " + std::to_string(i) + " " + without_control_characters(set->names[i]) + "\n";
    }
  }
  out += "element vertex " + std::to_string(mesh.positions.size()) + "\n";
  out += "property double x\nproperty double y\nproperty double z\n";
  out += "element face " + std::to_string(mesh.faces.size()) + "\n";
  // Nearly all programs write the list in this way. Ids from 2^31 on do not fit, but no program could read those.
  out += "property list uchar int vertex_indices\n";
  std::vector<const LabelSet*> used;
  for (const auto& [kind, set] : kinds) {
    if (!set->is_used()) continue;
    out += "property int " + kind + "\n";
    used.push_back(set);
  }
  out += "end_header\n";
  return used;
}

}  // namespace

std::string write_ply(const TriangleMesh& mesh, const std::vector<std::string>& comments, RunControl& control) {
  control.enter(Stage::kWrite);
  std::string out;
  const std::vector<const LabelSet*> used = write_ply_header(out, "binary_little_endian", mesh, comments);
  out.reserve(out.size() + 24 * mesh.positions.size() + (13 + 4 * used.size()) * mesh.faces.size());
  WriteProgress progress(mesh.positions.size() + mesh.faces.size(), control);
  for (const Vec3& position : mesh.positions) {
    progress.tick();
    for (int axis = 0; axis < 3; ++axis) append_little_endian(out, position[axis]);
  }
  FaceId f(0);
  for (const Triangle& face : mesh.faces) {
    progress.tick();
    append_little_endian(out, std::uint8_t{3});
    for (const VertexId v : face) append_little_endian(out, v.value);
    for (const LabelSet* set : used) append_little_endian(out, set->of_face[f]);
    ++f.value;
  }
  return out;
}

std::string write_ply_ascii(const TriangleMesh& mesh, const std::vector<std::string>& comments, RunControl& control) {
  control.enter(Stage::kWrite);
  std::string out;
  const std::vector<const LabelSet*> used = write_ply_header(out, "ascii", mesh, comments);
  const double share = share_of_vertices(mesh);
  append_points(out, mesh, share, control);
  append_triangles(out, mesh, share, used, control);
  return out;
}

}  // namespace remesh
