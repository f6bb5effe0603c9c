#include <algorithm>
#include <string_view>

#include "core/base/stoppable.h"
#include "core/io/common/number_parsing.h"
#include "core/io/common/write_text.h"
#include "core/io/msh/msh.h"

namespace remesh {
namespace {

constexpr int kSurface = 2;         // dimension of a physical group
constexpr int kTriangle = 2;        // Gmsh's number of the element type
constexpr int kTagsPerElement = 2;  // physical group and elementary entity

/// Makes a name that stays within its quotes and its line.
std::string quoted(std::string_view name) {
  std::string clean = without_control_characters(name.empty() ? "unnamed" : name);
  std::replace(clean.begin(), clean.end(), '"', '\'');
  return "\"" + clean + "\"";
}

void write_name(std::string& out, std::size_t tag, std::string_view name) {
  append_integer(out, kSurface);
  out += ' ';
  append_integer(out, tag);
  out += ' ';
  out += quoted(name);
  out += '\n';
}

/// Writes the number of each face's surface. Readers that do not know this section pass over it.
void write_surfaces(std::string& out, const WriterInput& input, RunControl& control) {
  // There is one text, the name; one real number, the time; and three integers: the number of the step in time, of
  // values per face, and of faces.
  out += "$ElementData\n1\n\"surface\"\n1\n0\n3\n0\n1\n";
  append_integer(out, input.face_patch.size());
  out += '\n';
  StopCheck check(control);
  std::uint64_t element = 0;
  for (const PatchId p : input.face_patch) {
    check();
    append_integer(out, ++element);
    out += ' ';
    append_integer(out, input.surface_of_patch[p.value].value);
    out += '\n';
  }
  out += "$EndElementData\n";
}

}  // namespace

std::string write_msh(const WriterInput& input, RunControl& control) {
  control.enter(Stage::kWrite);
  const TriangleMesh& mesh = input.mesh;
  const IdVector<FaceId, PatchId>& face_patch = input.face_patch;
  // If there are no labels, the patches become the physical groups.
  const LabelSet* const labels = dividing_labels(mesh.labels);
  std::string out = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
  if (!input.comments.empty()) {
    out += "$Comments\n";
    for (const std::string& comment : input.comments) {
      // A line that begins with a dollar would end the section.
      for (const std::string& line : comment_lines(comment)) out += "# " + line + "\n";
    }
    out += "$EndComments\n";
  }

  out += "$PhysicalNames\n";
  if (labels != nullptr) {
    append_integer(out, labels->names.size());
    out += '\n';
    for (std::size_t i = 0; i < labels->names.size(); ++i) write_name(out, i + 1, labels->names[i]);
  } else {
    std::size_t patches = 0;
    for (const PatchId p : face_patch) patches = std::max<std::size_t>(patches, std::size_t{p.value} + 1);
    append_integer(out, patches);
    out += '\n';
    StopCheck check(control);
    for (std::size_t p = 0; p < patches; ++p) {
      check();
      write_name(out, p + 1, "patch_" + std::to_string(p));
    }
  }
  out += "$EndPhysicalNames\n$Nodes\n";

  WriteProgress progress(mesh.positions.size() + mesh.faces.size(), control);
  append_integer(out, mesh.positions.size());
  out += '\n';
  std::uint64_t node = 0;
  for (const Vec3& position : mesh.positions) {
    progress.tick();
    append_integer(out, ++node);
    append_coordinates(out, position);
  }
  out += "$EndNodes\n$Elements\n";
  append_integer(out, mesh.faces.size());
  out += '\n';
  FaceId f(0);
  for (const Triangle& face : mesh.faces) {
    progress.tick();
    const std::uint64_t elementary = std::uint64_t{face_patch[f].value} + 1;
    const std::uint64_t physical = labels == nullptr ? elementary : std::uint64_t{labels->of_face[f]} + 1;
    append_integer(out, std::uint64_t{f.value} + 1);
    for (const std::uint64_t number :
         {std::uint64_t{kTriangle}, std::uint64_t{kTagsPerElement}, physical, elementary,
          std::uint64_t{face[0].value} + 1, std::uint64_t{face[1].value} + 1, std::uint64_t{face[2].value} + 1}) {
      out += ' ';
      append_integer(out, number);
    }
    out += '\n';
    ++f.value;
  }
  out += "$EndElements\n";
  if (!input.surface_of_patch.empty()) write_surfaces(out, input, control);
  return out;
}

}  // namespace remesh
