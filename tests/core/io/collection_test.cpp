/// Tests readers and writers on meshes from many programs, against facts that were computed by other means. Tests also
/// what becomes of meshes that are odd or broken.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "core/io/gzip.h"
#include "core/io/mesh_files.h"
#include "core/remesh.h"
#include "tests/support/shared_meshes.h"
#include "tests/support/unrefined_options.h"

namespace remesh {
namespace {

namespace fs = std::filesystem;

const fs::path kMeshes = test::shared_meshes_folder();

/// Returns the bytes of a file, decompressed.
std::string content_of(const std::string& name) {
  std::ifstream file(kMeshes / name, std::ios::binary);
  std::string content{std::istreambuf_iterator<char>(file), {}};
  RunControl control;
  return is_gzip(content) ? gunzip(content, {}, control) : content;
}

using Row = test::MeshFacts;

/// The error that ends the reading of a file, and its place.
struct Refusal {
  Code code;
  std::optional<std::uint64_t> line, byte;
};

/// The files that cannot be read. All other files can.
const std::map<std::string, Refusal> kRefused = {
    {"seed/PolyFile.obj", {Code::kEmptyMesh, {}, {}}},
    {"syntax/box_UTF16BE.obj", {Code::kInvalidMesh, 1, {}}},
    {"syntax/number_formats.obj", {Code::kInvalidMesh, 11, {}}},  // 3.1+e2
    {"malformed/OutOfMemory.off", {Code::kMeshTooLarge, 2, {}}},
    {"malformed/count_too_large.stl", {Code::kInvalidMesh, {}, 1484}},
    {"malformed/crash-header.ply", {Code::kInvalidMesh, 7, {}}},
    {"malformed/empty.obj", {Code::kEmptyMesh, {}, {}}},
    {"malformed/index_out_of_range.obj", {Code::kIndexOutOfRange, 21, {}}},
    {"malformed/invalid-relative-vertex-index.obj", {Code::kIndexOutOfRange, 1, {}}},
    {"malformed/issue-140-zero-face-idx.obj", {Code::kIndexOutOfRange, 16, {}}},
    {"malformed/malformed.obj", {Code::kIndexOutOfRange, 28, {}}},
    {"malformed/nan_inf_binary.stl", {Code::kNonfiniteCoordinate, {}, 246}},
    {"malformed/notenoughindices.obj", {Code::kInvalidMesh, 9, {}}},
    {"malformed/stl_empty_bin.stl", {Code::kEmptyMesh, {}, {}}},
    {"malformed/test-nan.obj", {Code::kNonfiniteCoordinate, 12, {}}},
    {"malformed/toomanyvertices.stl", {Code::kInvalidMesh, 92, {}}},
    {"malformed/truncated.obj", {Code::kInvalidMesh, 222, {}}},
    {"malformed/truncated_binary.stl", {Code::kInvalidMesh, {}, 1101}},
    {"malformed/unparseable.stl", {Code::kInvalidMesh, 4, {}}},
};
constexpr const char* kNoise = "malformed/garbage.obj";

ReadResult read_file(const std::string& name) {
  RunControl control;
  return read_mesh(*format_from_file_name(name), content_of(name), {}, control);
}

class collection : public testing::Test {
 protected:
  void SetUp() override { test::has_shared_mesh("facts.tsv"); }
  /// Calls `test` with the facts of each file that can be read; returns their number.
  template <class Test>
  int for_each_readable(const Test& test) {
    int files = 0;
    for (Row& row : facts_) {
      if (kRefused.count(row["file"]) > 0 || row["file"] == kNoise) continue;
      SCOPED_TRACE(row["file"]);
      test(row);
      ++files;
    }
    return files;
  }

  std::vector<Row> facts_ = test::shared_meshes_facts();
};

TEST_F(collection, counts_and_bounds_are_those_computed_by_other_means) {
  const int files = for_each_readable([](Row& row) {
    const PolygonMesh mesh = read_file(row["file"]).mesh;
    EXPECT_EQ(std::to_string(mesh.vertex_count()), row["vertices"]);
    EXPECT_EQ(std::to_string(mesh.face_count()), row["faces"]);
    std::set<std::size_t> sides;
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) sides.insert(mesh.face(FaceId(f)).size());
    const std::string range = std::to_string(*sides.begin());
    EXPECT_EQ(sides.size() == 1 ? range : range + "-" + std::to_string(*sides.rbegin()), row["sides"]);
    if (row["xmin"].empty()) return;
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
  });
  // The number of files in the collection is pinned, so that none goes missing unnoticed.
  constexpr int kPinnedFiles = 118;
  EXPECT_EQ(files, kPinnedFiles - static_cast<int>(kRefused.size()) - 1);
}

TEST_F(collection, the_content_tells_the_same_format_as_the_ending) {
  for_each_readable(
      [](Row& row) { EXPECT_EQ(sniff_format(content_of(row["file"])), format_from_file_name(row["file"])); });
}

TEST_F(collection, what_cannot_be_read_says_why_and_where_told_by_its_ending_or_its_content) {
  for (const auto& [name, expected] : kRefused) {
    const std::string content = content_of(name);
    for (const Format format : {*format_from_file_name(name), sniff_format(content)}) {
      SCOPED_TRACE(name + " as " + std::string(format_name(format)));
      RunControl control;
      try {
        (void)read_mesh(format, content, {}, control);
        ADD_FAILURE() << "was read";
      } catch (const Error& error) {
        EXPECT_EQ(code_name(error.code), code_name(expected.code)) << error.what();
        EXPECT_EQ(error.line, expected.line) << error.what();
        EXPECT_EQ(error.byte, expected.byte) << error.what();
      }
    }
  }
}

TEST_F(collection, noise_is_no_mesh_whatever_it_is_taken_for) {
  const std::string noise = content_of(kNoise);
  for (const Format format : {Format::kObj, Format::kStl, Format::kPly, Format::kOff, sniff_format(noise)}) {
    RunControl control;
    try {
      (void)read_mesh(format, noise, {}, control);
      ADD_FAILURE() << format_name(format);
    } catch (const Error& error) {
      EXPECT_EQ(error.code, Code::kInvalidMesh) << error.what();
      EXPECT_TRUE(error.line || error.byte) << error.what();
    }
  }
}

TEST_F(collection, what_is_odd_but_readable_is_remeshed_and_what_it_has_too_much_is_told) {
  int files = 0;
  for_each_readable([&](Row& row) {
    const std::string& name = row["file"];
    if (!name.starts_with("syntax/") && !name.starts_with("malformed/")) return;
    ReadResult input = read_file(name);
    const auto trailing = std::find_if(input.diagnostics.begin(), input.diagnostics.end(),
                                       [](const Diagnostic& d) { return d.code == DiagnosticCode::kTrailingBytes; });
    EXPECT_EQ(trailing != input.diagnostics.end(), name == "malformed/trailing_byte.stl");
    RunControl control;
    const Result result = remesh_surface(input.mesh, unrefined(), RunSettings{}, control, input.diagnostics);
    EXPECT_TRUE(result.report.verified.all_true());
    ++files;
  });
  // The number of such files in the collection is pinned, so that none goes missing unnoticed.
  constexpr int kPinnedFiles = 19;
  EXPECT_EQ(files, kPinnedFiles);
}

TEST_F(collection, two_solids_come_back_as_two_objects) {
  RunControl control;
  const ReadResult input = read_file("syntax/two_objects_mixed_case_names.stl");
  const Result result = remesh_surface(input.mesh, unrefined(), RunSettings{}, control);
  EXPECT_EQ(result.mesh.labels.object.names.size(), 2u);
  EXPECT_EQ(result.mesh.labels.object.of_face.size(), result.mesh.faces.size());
}

/// Cuts faces into fans from the first corner. The writers take triangles only, and here only the file matters.
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

TEST_F(collection, what_is_written_reads_back_bit_for_bit) {
  for_each_readable([](Row& row) {
    const TriangleMesh mesh = triangulated(read_file(row["file"]).mesh);
    const IdVector<FaceId, PatchId> patches(mesh.faces.size(), PatchId(0));
    for (const Format format : {Format::kObj, Format::kPly, Format::kOff}) {
      SCOPED_TRACE(format_name(format));
      RunControl control;
      const ReadResult back =
          read_mesh(format, write_mesh(format, {mesh, patches, {row["file"]}}, control), {}, control);
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
      if (format == Format::kOff) continue;  // it has no labels
      EXPECT_EQ(back.mesh.labels.object, mesh.labels.object);
      EXPECT_EQ(back.mesh.labels.group, mesh.labels.group);
      EXPECT_EQ(back.mesh.labels.material, mesh.labels.material);
      if (format == Format::kObj) {
        EXPECT_EQ(back.mesh.labels.material_libraries, mesh.labels.material_libraries);
      }
    }
  });
}

TEST_F(collection, what_is_floats_comes_back_through_binary_stl_bit_for_bit) {
  int files = 0;
  for_each_readable([&](Row& row) {
    const PolygonMesh mesh = read_file(row["file"]).mesh;
    const auto is_float = [](double x) { return static_cast<double>(static_cast<float>(x)) - x == 0; };
    const bool is_stl = std::all_of(mesh.positions.begin(), mesh.positions.end(),
                                    [&](const Vec3& p) { return is_float(p.x) && is_float(p.y) && is_float(p.z); });
    if (!is_stl || format_from_file_name(row["file"]) != Format::kStl) return;
    const TriangleMesh triangles = triangulated(mesh);
    const IdVector<FaceId, PatchId> patches(triangles.faces.size(), PatchId(0));
    RunControl control;
    const std::string file = write_mesh(Format::kStl, {triangles, patches, {}}, control);
    const PolygonMesh back = read_mesh(Format::kStl, file, {}, control).mesh;
    EXPECT_EQ(back.corners, mesh.corners);
    EXPECT_EQ(back.positions, mesh.positions);
    ++files;
  });
  EXPECT_GT(files, 10);
}

}  // namespace
}  // namespace remesh
