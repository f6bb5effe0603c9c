#include <algorithm>
#include <cstdint>
#include <map>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/grouping.h"
#include "core/base/stoppable.h"
#include "core/io/common/enclosed_volumes.h"
#include "core/io/common/number_parsing.h"
#include "core/io/common/write_text.h"
#include "core/io/msh/msh.h"

namespace remesh {
namespace {

constexpr int kSurface = 2;  // dimensions of entities
constexpr int kVolume = 3;
constexpr int kTriangle = 2;        // Gmsh's number of the element type
constexpr int kTagsPerElement = 2;  // physical group and elementary entity

/// Makes a name that stays within its quotes and its line.
std::string quotable(std::string_view name) {
  std::string clean = without_control_characters(name.empty() ? "unnamed" : name);
  std::replace(clean.begin(), clean.end(), '"', '\'');
  return clean;
}

/// Appends integers with blanks between them.
void append_integers(std::string& out, std::initializer_list<std::uint64_t> numbers) {
  for (const std::uint64_t& number : numbers) {
    if (&number != numbers.begin()) out += ' ';
    append_integer(out, number);
  }
}

void append_line(std::string& out, std::initializer_list<std::uint64_t> numbers) {
  append_integers(out, numbers);
  out += '\n';
}

/// The elementary entities of the surface: the pieces of patches that belong to one boundary each. In most cases a
/// patch is one piece. Gmsh would put both pieces of a patch into both physical groups if they had the same number.
class SurfaceEntities {
 public:
  SurfaceEntities(const WriterInput& input, const Boundaries& boundaries, RunControl& control) {
    const std::size_t faces = input.mesh.faces.size();
    StopCheck check(control);
    for (const PatchId p : input.face_patch) patches_ = std::max<std::size_t>(patches_, std::size_t{p.value} + 1);
    boundary_.assign(patches_, kNone);
    of_face_.reserve(faces);
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> other_pieces;
    for (std::size_t f = 0; f < faces; ++f) {
      check();
      const std::uint32_t patch = input.face_patch[FaceId(f)].value, boundary = boundaries.of(FaceId(f));
      std::uint32_t entity = patch;
      if (boundary_[patch] == kNone) boundary_[patch] = boundary;
      if (boundary_[patch] != boundary) {
        const auto [piece, is_new] =
            other_pieces.try_emplace({patch, boundary}, static_cast<std::uint32_t>(boundary_.size()));
        if (is_new) boundary_.push_back(boundary);
        entity = piece->second;
      }
      of_face_.push_back(entity);
    }
  }

  /// The number of entities, with those of patches that have no face. Their tags are the numbers from 1 on.
  std::size_t size() const { return boundary_.size(); }
  bool has_faces(std::size_t entity) const { return boundary_[entity] != kNone; }
  std::uint32_t boundary(std::size_t entity) const { return boundary_[entity]; }
  std::span<const std::uint32_t> of_face() const { return of_face_; }

 private:
  std::size_t patches_ = 0;
  std::vector<std::uint32_t> boundary_;  ///< by entity: those of patches first, then the other pieces
  std::vector<std::uint32_t> of_face_;
};

/// Makes the lines of Gmsh's language that fill the surface.
/// Output: none if the surface does not enclose volumes, or if it is not clear which.
std::vector<std::string> lines_that_fill(const WriterInput& input, const SurfaceEntities& entities,
                                         std::uint64_t physical_volume, std::string_view name, RunControl& control) {
  const EnclosedVolumes volumes = enclosed_volumes(input.mesh, control);
  if (!volumes.is_complete || volumes.all.empty()) return {};
  // The shell of each entity. A patch that several shells share belongs to no one.
  std::vector<std::uint32_t> shell_of(entities.size(), kNone);
  StopCheck check(control);
  for (std::size_t f = 0; f < input.mesh.faces.size(); ++f) {
    check();
    std::uint32_t& shell = shell_of[entities.of_face()[f]];
    if (shell != kNone && shell != volumes.shells.of_face[f]) return {};
    shell = volumes.shells.of_face[f];
  }
  const Grouping entities_of = group_by(
      entities.size(), volumes.shells.all.size() + 1,
      [&](std::uint32_t entity) {
        return shell_of[entity] == kNone ? static_cast<std::uint32_t>(volumes.shells.all.size()) : shell_of[entity];
      },
      control);

  std::vector<std::string> lines;
  for (std::size_t shell = 0; shell < volumes.shells.all.size(); ++shell) {
    std::string line = "Surface Loop(" + std::to_string(shell + 1) + ") = {";
    const std::span<const std::uint32_t> tags = entities_of[shell];
    for (std::size_t i = 0; i < tags.size();) {
      check();
      std::size_t last = i;
      while (last + 1 < tags.size() && tags[last + 1] == tags[last] + 1) ++last;
      line += (i > 0 ? ", " : "") + std::to_string(tags[i] + 1);
      if (last > i) line += ":" + std::to_string(tags[last] + 1);
      i = last + 1;
    }
    lines.push_back(line + "};");
  }
  std::size_t solids = 0;
  for (const EnclosedVolume& volume : volumes.all) {
    if (!volume.is_solid) continue;
    std::string line = "Volume(" + std::to_string(++solids) + ") = {" + std::to_string(volume.shell + 1);
    for (const std::uint32_t shell : volume.shells_within) line += ", " + std::to_string(shell + 1);
    lines.push_back(line + "};");
  }
  lines.push_back("Physical Volume(\"" + std::string(name) + "\", " + std::to_string(physical_volume) +
                  ") = {1:" + std::to_string(solids) + "};");
  return lines;
}

void write_comments(std::string& out, const std::vector<std::string>& comments,
                    const std::vector<std::string>& filling) {
  if (comments.empty() && filling.empty()) return;
  out += "$Comments\n";
  for (const std::string& comment : comments) {
    // A line that begins with a dollar would end the section.
    for (const std::string& line : comment_lines(comment)) out += "# " + line + "\n";
  }
  if (!filling.empty())
    out += "# With these lines behind a line 'Merge \"NAME.msh\";' in a file, gmsh -3 fills the surface:\n";
  for (const std::string& line : filling) out += line + "\n";
  out += "$EndComments\n";
}

void write_nodes_22(std::string& out, const TriangleMesh& mesh, WriteProgress& progress) {
  out += "$Nodes\n";
  append_line(out, {mesh.positions.size()});
  std::uint64_t node = 0;
  for (const Vec3& position : mesh.positions) {
    progress.tick();
    append_integer(out, ++node);
    append_coordinates(out, position);
  }
  out += "$EndNodes\n";
}

void write_elements_22(std::string& out, const TriangleMesh& mesh, const SurfaceEntities& entities,
                       WriteProgress& progress) {
  out += "$Elements\n";
  append_line(out, {mesh.faces.size()});
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) {
    progress.tick();
    const auto& [a, b, c] = mesh.faces[FaceId(f)];
    const std::uint64_t entity = entities.of_face()[f];
    append_line(out, {std::uint64_t{f} + 1, kTriangle, kTagsPerElement, std::uint64_t{entities.boundary(entity)} + 1,
                      entity + 1, std::uint64_t{a.value} + 1, std::uint64_t{b.value} + 1, std::uint64_t{c.value} + 1});
  }
  out += "$EndElements\n";
}

/// Writes the entities of version 4.1: a number of points, of curves, of surfaces and of volumes, and a line for each
/// surface with its box, its physical group and no bounding curves.
void write_entities(std::string& out, const TriangleMesh& mesh, const SurfaceEntities& entities, RunControl& control) {
  std::vector<Box3> boxes(entities.size());
  StopCheck check(control);
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) {
    check();
    for (const VertexId v : mesh.faces[FaceId(f)]) boxes[entities.of_face()[f]].add(mesh.positions[v]);
  }
  std::size_t used = 0;
  for (std::size_t e = 0; e < entities.size(); ++e) used += entities.has_faces(e) ? 1 : 0;
  out += "$Entities\n";
  append_line(out, {0, 0, used, 0});
  for (std::size_t e = 0; e < entities.size(); ++e) {
    check();
    if (!entities.has_faces(e)) continue;
    append_integer(out, e + 1);
    for (const Vec3& corner : {boxes[e].min, boxes[e].max})
      for (int axis = 0; axis < 3; ++axis) {
        out += ' ';
        append_real(out, corner[axis]);
      }
    out += " 1 ";
    append_line(out, {std::uint64_t{entities.boundary(e)} + 1, 0});
  }
  out += "$EndEntities\n";
}

/// Writes all nodes as one block. It belongs to the surface of the first face.
void write_nodes_41(std::string& out, const TriangleMesh& mesh, const SurfaceEntities& entities,
                    WriteProgress& progress) {
  const std::size_t n = mesh.positions.size();
  out += "$Nodes\n";
  append_line(out, {n > 0 ? 1u : 0u, n, 1, n});
  if (n > 0) {
    append_line(out, {kSurface, std::uint64_t{mesh.faces.empty() ? 0 : entities.of_face()[0]} + 1, 0, n});
    for (std::size_t node = 1; node <= n; ++node) append_line(out, {node});
    for (const Vec3& position : mesh.positions) {
      progress.tick();
      append_point(out, position);
      out += '\n';
    }
  }
  out += "$EndNodes\n";
}

/// Writes the triangles, one block for each entity. Their tags are those of the faces, from 1 on.
void write_elements_41(std::string& out, const TriangleMesh& mesh, const SurfaceEntities& entities,
                       WriteProgress& progress, RunControl& control) {
  const std::size_t n = mesh.faces.size();
  const Grouping faces_of = group_by(
      n, entities.size(), [&](std::uint32_t f) { return entities.of_face()[f]; }, control);
  std::size_t used = 0;
  for (std::size_t e = 0; e < entities.size(); ++e) used += faces_of[e].empty() ? 0 : 1;
  out += "$Elements\n";
  append_line(out, {used, n, n > 0 ? 1u : 0u, n});
  for (std::size_t e = 0; e < entities.size(); ++e) {
    if (faces_of[e].empty()) continue;
    append_line(out, {kSurface, e + 1, kTriangle, faces_of[e].size()});
    for (const std::uint32_t f : faces_of[e]) {
      progress.tick();
      const auto& [a, b, c] = mesh.faces[FaceId(f)];
      append_line(out, {std::uint64_t{f} + 1, std::uint64_t{a.value} + 1, std::uint64_t{b.value} + 1,
                        std::uint64_t{c.value} + 1});
    }
  }
  out += "$EndElements\n";
}

/// Writes the number of each face's surface. Readers that do not know this section pass over it.
void write_surfaces(std::string& out, const WriterInput& input, RunControl& control) {
  // There is one text, the name; one real number, the time; and three integers: the number of the step in time, of
  // values per face, and of faces.
  out += "$ElementData\n1\n\"surface\"\n1\n0\n3\n0\n1\n";
  append_line(out, {input.face_patch.size()});
  StopCheck check(control);
  std::uint64_t element = 0;
  for (const PatchId p : input.face_patch) {
    check();
    append_line(out, {++element, input.surface_of_patch[p.value].value});
  }
  out += "$EndElementData\n";
}

}  // namespace

std::vector<std::string> msh_filling(const WriterInput& input, RunControl& control) {
  Boundaries boundaries = msh_boundaries(input, control);
  return lines_that_fill(input, SurfaceEntities(input, boundaries, control), boundaries.size() + 1,
                         boundaries.other_name("volume"), control);
}

Boundaries msh_boundaries(const WriterInput& input, RunControl& control) { return {input, control, quotable}; }

std::string write_msh(const WriterInput& input, RunControl& control) {
  control.enter(Stage::kWrite);
  const TriangleMesh& mesh = input.mesh;
  Boundaries boundaries = msh_boundaries(input, control);
  const SurfaceEntities entities(input, boundaries, control);
  // Programs expect that no two groups have the same number, whatever their dimensions.
  const std::uint64_t physical_volume = boundaries.size() + 1;
  const std::string volume_name = boundaries.other_name("volume");
  const std::vector<std::string> filling = lines_that_fill(input, entities, physical_volume, volume_name, control);

  const bool is_new = input.writing.msh_version == MshVersion::k41;
  std::string out = is_new ? "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n" : "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
  write_comments(out, input.comments, filling);

  out += "$PhysicalNames\n";
  std::size_t named = filling.empty() ? 0 : 1;
  for (std::size_t i = 0; i < boundaries.size(); ++i) named += boundaries.has_faces(i) ? 1 : 0;
  append_line(out, {named});
  StopCheck check(control);
  const auto append_name = [&](std::uint64_t dimension, std::uint64_t tag, const std::string& name) {
    append_integers(out, {dimension, tag});
    out.append(" \"").append(name).append("\"\n");
  };
  for (std::size_t i = 0; i < boundaries.size(); ++i) {
    check();
    if (boundaries.has_faces(i)) append_name(kSurface, i + 1, boundaries.name(i));
  }
  if (!filling.empty()) append_name(kVolume, physical_volume, volume_name);
  out += "$EndPhysicalNames\n";

  WriteProgress progress(mesh.positions.size() + mesh.faces.size(), control);
  if (is_new) {
    write_entities(out, mesh, entities, control);
    write_nodes_41(out, mesh, entities, progress);
    write_elements_41(out, mesh, entities, progress, control);
  } else {
    write_nodes_22(out, mesh, progress);
    write_elements_22(out, mesh, entities, progress);
  }
  if (!input.surface_of_patch.empty()) write_surfaces(out, input, control);
  return out;
}

}  // namespace remesh
