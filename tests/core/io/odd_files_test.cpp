/// What becomes of the odd and the broken files of the shared collection, as a server sees them, without a name, and as
/// the command line does, by their ending.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/io/mesh_files.h"
#include "core/remesh.h"
#include "tests/support/shared_meshes.h"
#include "tests/support/unrefined_options.h"

namespace remesh {
namespace {

namespace fs = std::filesystem;
const fs::path kMeshes = test::shared_meshes_folder();

/// What ends a file's reading, and where.
struct Refusal {
  Code code;
  std::optional<std::uint64_t> line, byte;
};
const std::map<std::string, Refusal> kRefused = {
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
    {"syntax/box_UTF16BE.obj", {Code::kInvalidMesh, 1, {}}},
    {"syntax/number_formats.obj", {Code::kInvalidMesh, 11, {}}},
};

std::string content_of(const std::string& name) {
  std::ifstream file(kMeshes / name, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<std::string> odd_files() {
  std::vector<std::string> names;
  for (const char* folder : {"malformed", "syntax"}) {
    for (const auto& entry : fs::directory_iterator(kMeshes / folder)) {
      names.push_back(std::string(folder) + "/" + entry.path().filename().string());
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

class OddFiles : public testing::Test {
 protected:
  void SetUp() override {
    if (!fs::is_directory(kMeshes)) GTEST_SKIP() << "NO SHARED MESHES at " << kMeshes << ": nothing is tested here";
  }
};

TEST_F(OddFiles, each_is_refused_where_it_is_wrong_or_read_and_remeshed_whole) {
  int remeshed = 0;
  for (const std::string& name : odd_files()) {
    if (name == "malformed/garbage.obj") continue;  // see below
    const std::string content = content_of(name);
    for (const Format format : {*format_from_file_name(name), sniff_format(content)}) {
      SCOPED_TRACE(name + " as " + std::string(format_name(format)));
      const auto refusal = kRefused.find(name);
      RunControl control;
      try {
        ReadResult read = read_mesh(format, content, {}, control);
        EXPECT_EQ(refusal, kRefused.end()) << "was read";
        const bool has_trailing =
            std::any_of(read.diagnostics.begin(), read.diagnostics.end(),
                        [](const Diagnostic& d) { return d.code == DiagnosticCode::kTrailingBytes && d.count == 1; });
        EXPECT_EQ(has_trailing, name == "malformed/trailing_byte.stl");
        const Result result = remesh_surface(read.mesh, unrefined(), RunSettings{}, control, read.diagnostics);
        EXPECT_TRUE(result.report.verified.all_true());
        ++remeshed;
      } catch (const Error& error) {
        ASSERT_NE(refusal, kRefused.end()) << code_name(error.code) << ": " << error.what();
        EXPECT_EQ(code_name(error.code), code_name(refusal->second.code)) << error.what();
        EXPECT_EQ(error.line, refusal->second.line) << error.what();
        EXPECT_EQ(error.byte, refusal->second.byte) << error.what();
      }
    }
  }
  EXPECT_EQ(remeshed, 2 * 19);
}

TEST_F(OddFiles, noise_is_no_mesh_whatever_it_is_taken_for) {
  const std::string noise = content_of("malformed/garbage.obj");
  for (const Format format : {Format::kObj, Format::kStl, Format::kPly, Format::kOff}) {
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

TEST_F(OddFiles, two_solids_come_back_as_two_objects) {
  RunControl control;
  const ReadResult read = read_mesh(Format::kStl, content_of("syntax/two_objects_mixed_case_names.stl"), {}, control);
  const Result result = remesh_surface(read.mesh, unrefined(), RunSettings{}, control);
  EXPECT_EQ(result.mesh.labels.object.names.size(), 2u);
  EXPECT_EQ(result.mesh.labels.object.of_face.size(), result.mesh.faces.size());
}

}  // namespace
}  // namespace remesh
