/// The OBJ reader and writer on meshes from many programs, against facts computed by other means.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "core/io/obj.h"
#include "tests/support/shared_meshes.h"

namespace remesh {
namespace {

namespace fs = std::filesystem;

const fs::path kMeshes = test::shared_meshes_folder();

/// The file's bytes, unpacked if its name ends in `.gz`.
std::string content(const fs::path& path) {
  const std::string command = (path.extension() == ".gz" ? "gzip -dc '" : "cat '") + path.string() + "'";
  std::FILE* const pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return {};
  std::string text;
  char buffer[1 << 16];
  while (const std::size_t n = std::fread(buffer, 1, sizeof buffer, pipe)) text.append(buffer, n);
  EXPECT_EQ(pclose(pipe), 0) << command;
  return text;
}

using Row = std::map<std::string, std::string>;

/// The rows of facts.tsv whose file is an OBJ; empty if the meshes are not there.
std::vector<Row> obj_facts() {
  std::ifstream file(kMeshes / "facts.tsv");
  std::vector<Row> rows;
  std::vector<std::string> columns;
  for (std::string line; std::getline(file, line);) {
    std::istringstream fields(line);
    std::vector<std::string> values;
    for (std::string value; std::getline(fields, value, '\t');) values.push_back(value);
    if (columns.empty()) {
      columns = values;
      continue;
    }
    Row row;
    for (std::size_t i = 0; i < columns.size(); ++i) row[columns[i]] = i < values.size() ? values[i] : "";
    if (row["file"].find(".obj") != std::string::npos) rows.push_back(row);
  }
  return rows;
}

/// What cannot be read, with the code and the line; everything else can.
const std::map<std::string, std::pair<Code, std::optional<std::uint64_t>>> kRefused = {
    {"seed/PolyFile.obj", {Code::kEmptyMesh, std::nullopt}},
    {"syntax/box_UTF16BE.obj", {Code::kInvalidMesh, 1}},
    {"syntax/number_formats.obj", {Code::kInvalidMesh, 11}},  // 3.1+e2
    {"malformed/malformed.obj", {Code::kIndexOutOfRange, 28}},
    {"malformed/empty.obj", {Code::kEmptyMesh, std::nullopt}},
    {"malformed/notenoughindices.obj", {Code::kInvalidMesh, 9}},
    {"malformed/invalid-relative-vertex-index.obj", {Code::kIndexOutOfRange, 1}},
    {"malformed/issue-140-zero-face-idx.obj", {Code::kIndexOutOfRange, 16}},
    {"malformed/test-nan.obj", {Code::kNonfiniteCoordinate, 12}},
    {"malformed/truncated.obj", {Code::kInvalidMesh, 222}},
    {"malformed/index_out_of_range.obj", {Code::kIndexOutOfRange, 21}},
    {"malformed/garbage.obj", {Code::kInvalidMesh, 1}},
};

#define SKIP_WITHOUT_MESHES(facts) \
  if ((facts).empty()) GTEST_SKIP() << "NOT TESTED: the collection of meshes is not at " << kMeshes

TEST(obj_meshes, counts_and_bounds_are_those_computed_by_other_means) {
  const std::vector<Row> facts = obj_facts();
  SKIP_WITHOUT_MESHES(facts);
  for (Row row : facts) {
    const std::string name = row["file"];
    if (kRefused.count(name) > 0) continue;
    SCOPED_TRACE(name);
    RunControl control;
    const PolygonMesh mesh = read_obj(content(kMeshes / name), {}, control).mesh;
    EXPECT_EQ(std::to_string(mesh.vertex_count()), row["vertices"]);
    EXPECT_EQ(std::to_string(mesh.face_count()), row["faces"]);
    std::set<std::size_t> sides;
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) sides.insert(mesh.face(FaceId(f)).size());
    const std::string range = std::to_string(*sides.begin());
    EXPECT_EQ(sides.size() == 1 ? range : range + "-" + std::to_string(*sides.rbegin()), row["sides"]);
    if (row["xmin"].empty()) continue;
    Box3 box;
    for (const Vec3& p : mesh.positions) box.add(p);
    const auto expect_close = [&](double value, const char* column) {
      const double fact = std::stod(row[column]);
      EXPECT_NEAR(value, fact, std::fabs(fact) * 1e-8) << column;
    };
    expect_close(box.min.x, "xmin");
    expect_close(box.min.y, "ymin");
    expect_close(box.min.z, "zmin");
    expect_close(box.max.x, "xmax");
    expect_close(box.max.y, "ymax");
    expect_close(box.max.z, "zmax");
  }
}

TEST(obj_meshes, what_cannot_be_read_says_why_and_where) {
  const std::vector<Row> facts = obj_facts();
  SKIP_WITHOUT_MESHES(facts);
  for (const auto& [name, expected] : kRefused) {
    SCOPED_TRACE(name);
    RunControl control;
    try {
      (void)read_obj(content(kMeshes / name), {}, control);
      ADD_FAILURE() << "was read";
    } catch (const Error& error) {
      EXPECT_EQ(code_name(error.code), code_name(expected.first)) << error.what();
      EXPECT_EQ(error.line, expected.second) << error.what();
    }
  }
}

/// Fans from the first corner: the writer takes triangles only, and here only the file matters.
TriangleMesh triangulated(PolygonMesh mesh) {
  TriangleMesh result;
  const auto labels_of = [](FaceLabels& l) { return std::array{&l.object, &l.group, &l.material}; };
  result.labels = mesh.labels;
  for (LabelSet* set : labels_of(result.labels)) set->of_face.clear();
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.face(FaceId(f));
    for (std::size_t i = 2; i < face.size(); ++i) {
      result.faces.push_back({face[0], face[i - 1], face[i]});
      for (int kind = 0; kind < 3; ++kind) {
        const LabelSet& from = *labels_of(mesh.labels)[kind];
        if (from.is_used()) labels_of(result.labels)[kind]->of_face.push_back(from.of_face[FaceId(f)]);
      }
    }
  }
  result.positions = std::move(mesh.positions);
  return result;
}

TEST(obj_meshes, what_is_written_reads_back_bit_for_bit) {
  const std::vector<Row> facts = obj_facts();
  SKIP_WITHOUT_MESHES(facts);
  for (Row row : facts) {
    const std::string name = row["file"];
    if (kRefused.count(name) > 0) continue;
    SCOPED_TRACE(name);
    RunControl control;
    const TriangleMesh mesh = triangulated(read_obj(content(kMeshes / name), {}, control).mesh);
    const ReadResult back = read_obj(write_obj(mesh, {name}, control), {}, control);
    EXPECT_TRUE(back.diagnostics.empty());
    ASSERT_EQ(back.mesh.vertex_count(), mesh.positions.size());
    EXPECT_EQ(std::memcmp(back.mesh.positions.items().data(), mesh.positions.items().data(),
                          mesh.positions.size() * sizeof(Vec3)),
              0);
    ASSERT_EQ(back.mesh.corners.size(), 3 * mesh.faces.size());
    for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) {
      const auto face = back.mesh.face(FaceId(f));
      ASSERT_TRUE(std::equal(face.begin(), face.end(), mesh.faces[FaceId(f)].begin(), mesh.faces[FaceId(f)].end()))
          << f;
    }
    EXPECT_EQ(back.mesh.labels, mesh.labels);
  }
}

}  // namespace
}  // namespace remesh
