#include "core/io/common/boundaries.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "core/io/mesh_files.h"

namespace remesh {
namespace {

/// The names that a mesh with these groups, one on each face, has in a file.
struct Named {
  std::vector<std::string> names;
  std::vector<RenamedLabel> renamed;
};

TriangleMesh one_face_each(const std::vector<std::string>& groups) {
  TriangleMesh mesh;
  for (const Vec3& p : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}}) mesh.positions.push_back(p);
  mesh.labels.group.names = groups;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    mesh.faces.push_back({VertexId(0), VertexId(1), VertexId(2)});
    mesh.labels.group.of_face.push_back(static_cast<std::uint32_t>(i));
  }
  return mesh;
}

Named named(const std::vector<std::string>& groups, NameRule rule = NameRule::kPortable) {
  const TriangleMesh mesh = one_face_each(groups);
  const IdVector<FaceId, PatchId> patches(groups.size(), PatchId(0));
  RunControl control;
  const WriterInput input{mesh, patches, {}, {}, {.names = rule}};
  const Boundaries boundaries(input, control);
  Named named{{}, boundaries.renamed()};
  for (std::size_t i = 0; i < boundaries.size(); ++i) named.names.push_back(boundaries.name(i));
  return named;
}

TEST(boundaries, a_name_that_every_program_reads_stays) {
  const std::vector<std::string> names{"inlet", "wall_2", "A-b.c", "9", "_", std::string(120, 'x')};
  EXPECT_EQ(named(names).names, names);
  EXPECT_TRUE(named(names).renamed.empty());
}

TEST(boundaries, what_is_not_portable_becomes_an_underscore_and_long_names_are_cut) {
  EXPECT_EQ(named({"Wand größe 1", "a\"b\n", "caf\xe9!", "", std::string(200, 'y')}).names,
            (std::vector<std::string>{"Wand_gr__e_1", "a_b_", "caf__", "unnamed", std::string(120, 'y')}));
}

TEST(boundaries, changed_names_never_take_the_name_of_another_one) {
  const Named result = named({"my part", "my_part", "my-part", "my$part", "my_part_2", "my_part"});
  EXPECT_EQ(result.names,
            (std::vector<std::string>{"my_part_3", "my_part", "my-part", "my_part_4", "my_part_2", "my_part_5"}));
  EXPECT_EQ(result.renamed,
            (std::vector<RenamedLabel>{{"my part", "my_part_3"}, {"my$part", "my_part_4"}, {"my_part", "my_part_5"}}));
}

TEST(boundaries, ten_thousand_names_that_begin_alike_are_told_apart_within_their_length) {
  std::vector<std::string> names;
  for (int i = 0; i < 10'000; ++i) names.push_back(std::string(118, 'n') + std::to_string(i) + std::string(9, 'z'));
  std::vector<std::string> made = named(names).names;
  for (const std::string& name : made) ASSERT_TRUE(PortableNames::is_portable(name)) << name;
  EXPECT_EQ(std::set<std::string>(made.begin(), made.end()).size(), made.size());
}

TEST(boundaries, exact_names_are_as_they_came_but_for_line_ends) {
  const Named result = named({"Wand größe 1", "", "a\nb", std::string(200, 'y')}, NameRule::kExact);
  EXPECT_EQ(result.names, (std::vector<std::string>{"Wand größe 1", "", "a b", std::string(200, 'y')}));
  EXPECT_EQ(result.renamed, (std::vector<RenamedLabel>{{"a\nb", "a b"}}));
}

/// A square of two faces: two patches, two groups, one object, and materials the other way round.
struct Square {
  TriangleMesh mesh = one_face_each({"g0", "g1", "unused"});
  IdVector<FaceId, PatchId> patches;
  std::vector<SurfaceId> surfaces{SurfaceId(4), SurfaceId(2)};

  Square() {
    mesh.faces.items().pop_back();
    mesh.labels.group.of_face.items() = {0, 1};
    mesh.labels.object = {{"o"}, {}};
    mesh.labels.object.of_face.items() = {0, 0};
    mesh.labels.material = {{"m0", "m1"}, {}};
    mesh.labels.material.of_face.items() = {1, 0};
    patches.items() = {PatchId(0), PatchId(1)};
  }
  std::string solids(Writing writing) const {
    RunControl control;
    const std::string text = write_mesh(Format::kStlAscii, {mesh, patches, {}, surfaces, writing}, control);
    std::string names;
    for (std::size_t at = 0; (at = text.find("\nsolid ", at)) != std::string::npos; ++at)
      names += " " + text.substr(at + 7, text.find('\n', at + 1) - at - 7);
    return text.substr(6, text.find('\n') - 6) + names;
  }
};

TEST(boundaries, the_option_label_chooses_what_names_them) {
  const Square square;
  EXPECT_EQ(square.solids({}), "g0 g1");
  EXPECT_EQ(square.solids({.label = LabelChoice::kGroup}), "g0 g1");
  EXPECT_EQ(square.solids({.label = LabelChoice::kObject}), "o");
  EXPECT_EQ(square.solids({.label = LabelChoice::kMaterial}), "m0 m1");
  EXPECT_EQ(square.solids({.label = LabelChoice::kPatch}), "patch_0 patch_1");
  EXPECT_EQ(square.solids({.label = LabelChoice::kSurface}), "surface_2 surface_4");
  EXPECT_EQ(square.solids({.stl_solids = StlSolids::kOne}), "");
}

TEST(boundaries, without_the_labels_that_are_asked_for_stl_is_one_solid_and_other_formats_have_the_patches) {
  Square square;
  square.mesh.labels.material = {};
  EXPECT_EQ(square.solids({.label = LabelChoice::kMaterial}), "");
  RunControl control;
  const std::string medit =
      write_mesh(Format::kMesh, {square.mesh, square.patches, {}, {}, {.label = LabelChoice::kMaterial}}, control);
  EXPECT_NE(medit.find("# reference 1: patch_0\n# reference 2: patch_1\n"), std::string::npos) << medit;
}

}  // namespace
}  // namespace remesh
