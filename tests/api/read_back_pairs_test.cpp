// A mesh that is written in one format, read back, written in another one and read back again is the same mesh, with
// the labels that both can hold: every pair of formats that are read and written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "api/json_reader.h"
#include "api/json_writer.h"
#include "api/report_json.h"
#include "core/io/format_spec.h"

namespace remesh::api {
namespace {

/// A format, and one of the ways in which it is written.
struct Way {
  Format format;
  Writing writing = {.names = NameRule::kExact};
};

std::vector<Way> all_ways() {
  std::vector<Way> ways;
  for (const Format format : kFormats) {
    if (!is_written(format) || format == Format::kSmesh) continue;  // nobody reads smesh here
    ways.push_back({format});
    if (format == Format::kMsh) ways.push_back({format, {.names = NameRule::kExact, .msh_version = MshVersion::k41}});
  }
  return ways;
}

std::string name_of(const Way& way) {
  return std::string(format_name(way.format)) + (way.writing.msh_version == MshVersion::k41 ? " 4.1" : "");
}

/// A pyramid over a square with coordinates of 17 digits, with two objects, three groups and two materials. None of the
/// labels divides the faces as another one does.
TriangleMesh pyramid(const std::array<std::string, 3>& groups) {
  TriangleMesh mesh;
  const double third = 1.0 / 3;
  for (const Vec3& p : {Vec3{0.1, 0, 0}, Vec3{1, 0, 0}, Vec3{1, 1.1, 0}, Vec3{0, 1, 0}, Vec3{third, third, 2 * third}})
    mesh.positions.push_back(p);
  using Corners = std::array<std::uint32_t, 3>;
  for (const auto& [a, b, c] :
       {Corners{0, 2, 1}, Corners{0, 3, 2}, Corners{0, 1, 4}, Corners{1, 2, 4}, Corners{2, 3, 4}, Corners{3, 0, 4}})
    mesh.faces.push_back({VertexId(a), VertexId(b), VertexId(c)});
  const auto set = [](std::vector<std::string> names, const std::vector<std::uint32_t>& of_face) {
    LabelSet labels{std::move(names), {}};
    for (const std::uint32_t label : of_face) labels.of_face.push_back(label);
    return labels;
  };
  mesh.labels.object = set({"base plate", "roof"}, {0, 0, 1, 1, 1, 1});
  mesh.labels.group = set({groups[0], groups[1], groups[2]}, {0, 1, 1, 2, 2, 0});
  mesh.labels.material = set({"steel", "zinc"}, {0, 1, 0, 1, 0, 1});
  return mesh;
}

Vec3 in_floats(const Vec3& p) { return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)}; }

std::string written(const TriangleMesh& mesh, const Way& way) {
  RunControl control;
  Result result;
  result.mesh = mesh;
  if (storage_of(way.format) == Storage::kFloat)
    for (Vec3& p : result.mesh.positions.items()) p = in_floats(p);
  result.face_patch = IdVector<FaceId, PatchId>(mesh.faces.size(), PatchId(0));
  if (way.format == Format::kJson) {
    JsonWriter json;
    write_mesh(json, result, control);
    return json.take();
  }
  const std::vector<SurfaceId> surfaces(1, SurfaceId(0));
  return format_spec(way.format).write({result.mesh, result.face_patch, {}, surfaces, way.writing}, control);
}

/// Errors: the test fails if a face is no triangle.
TriangleMesh read_back(const std::string& file, Format format) {
  RunControl control;
  OptionReader options;
  if (format == Format::kStlAscii) format = Format::kStl;
  if (format == Format::kPlyAscii) format = Format::kPly;
  PolygonMesh read = format == Format::kJson ? read_json(file, {}, control, options).mesh
                                             : format_spec(format).read(file, {}, control).mesh;
  TriangleMesh mesh{std::move(read.positions), {}, std::move(read.labels)};
  for (std::uint32_t f = 0; f + 1 < read.face_begin.size(); ++f) {
    const auto corners = std::span(read.corners).subspan(read.face_begin[f]);
    EXPECT_EQ(read.face_begin[f + 1] - read.face_begin[f], 3u);
    mesh.faces.push_back({corners[0], corners[1], corners[2]});
  }
  return mesh;
}

/// The faces of a mesh, whatever the order of its vertices and faces: the corners, beginning with the smallest, and
/// names.
using Faces = std::map<std::array<Vec3, 3>, std::vector<std::string>>;

Faces faces_of(const TriangleMesh& mesh, bool are_floats, const std::vector<const LabelSet*>& labels) {
  Faces faces;
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) {
    std::array<Vec3, 3> corners;
    for (int i = 0; i < 3; ++i) {
      corners[i] = mesh.positions[mesh.faces[FaceId(f)][i]];
      if (are_floats) corners[i] = in_floats(corners[i]);
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    std::vector<std::string>& names = faces[corners];
    for (const LabelSet* set : labels) names.push_back(set->is_used() ? set->names[set->of_face[FaceId(f)]] : "none");
  }
  return faces;
}

/// The labels that a mesh has after it was in these formats.
std::vector<const LabelSet*> held(const TriangleMesh& mesh, LabelsHeld labels) {
  if (labels == LabelsHeld::kNone) return {};
  if (labels == LabelsHeld::kAll) return {&mesh.labels.object, &mesh.labels.group, &mesh.labels.material};
  const LabelSet* set = chosen_labels(mesh.labels, LabelChoice::kAuto);
  EXPECT_NE(set, nullptr);
  return set == nullptr ? std::vector<const LabelSet*>{} : std::vector{set};
}

TEST(read_back_pairs, a_mesh_comes_back_from_every_pair_of_formats_with_the_labels_that_both_hold) {
  const TriangleMesh mesh = pyramid({"inlet", "Wand größe 1", std::string(200, 'w')});
  const std::vector<Way> ways = all_ways();
  ASSERT_EQ(ways.size(), 12u) << "formats that are read and written, MSH in two versions";
  for (const Way& first : ways) {
    const TriangleMesh between = read_back(written(mesh, first), first.format);
    for (const Way& second : ways) {
      SCOPED_TRACE(name_of(first) + ", then " + name_of(second));
      const TriangleMesh last = read_back(written(between, second), second.format);
      const bool are_floats =
          storage_of(first.format) == Storage::kFloat || storage_of(second.format) == Storage::kFloat;
      const LabelsHeld labels = std::min(format_spec(first.format).labels, format_spec(second.format).labels);
      EXPECT_EQ(last.positions.size(), mesh.positions.size());
      EXPECT_EQ(faces_of(last, false, held(last, labels)), faces_of(mesh, are_floats, held(mesh, labels)));
    }
  }
}

TEST(read_back_pairs, names_that_need_no_change_come_back_although_names_are_portable) {
  const TriangleMesh mesh = pyramid({"inlet", "Wand_1", "out.let-2"});
  for (Way way : all_ways()) {
    if (format_spec(way.format).labels == LabelsHeld::kNone) continue;
    SCOPED_TRACE(name_of(way));
    way.writing.names = NameRule::kPortable;
    const TriangleMesh back = read_back(written(mesh, way), way.format);
    const bool are_floats = storage_of(way.format) == Storage::kFloat;
    EXPECT_EQ(faces_of(back, false, held(back, LabelsHeld::kOne)),
              faces_of(mesh, are_floats, held(mesh, LabelsHeld::kOne)));
  }
}

}  // namespace
}  // namespace remesh::api
