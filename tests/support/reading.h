/// Helpers for tests of the readers: reading from literals, and checks of results and errors.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/io/formats.h"

namespace remesh::test {

using Reader = ReadResult (*)(std::string_view, const ReadLimits&, RunControl&);

inline ReadResult read_with(Reader reader, std::string_view content, const ReadLimits& limits = {}) {
  RunControl control;
  return reader(content, limits, control);
}

/// Returns the error with which reading ends. The test fails if there is none.
inline Error error_of(Reader reader, std::string_view content, const ReadLimits& limits = {}) {
  try {
    (void)read_with(reader, content, limits);
  } catch (const Error& error) {
    EXPECT_EQ(error.stage, Stage::kRead);
    return error;
  }
  ADD_FAILURE() << "read without an error: " << content.substr(0, 200);
  return Error(Code::kInternal, Stage::kQueued, "none");
}

inline void expect_error_at_line(Reader reader, std::string_view content, Code code, std::uint64_t line) {
  const Error error = error_of(reader, content);
  EXPECT_EQ(code_name(error.code), code_name(code)) << content.substr(0, 300) << ": " << error.what();
  EXPECT_EQ(error.line, line) << content.substr(0, 300) << ": " << error.what();
}

inline void expect_error_at_byte(Reader reader, std::string_view content, Code code, std::uint64_t byte) {
  const Error error = error_of(reader, content);
  EXPECT_EQ(code_name(error.code), code_name(code)) << error.what();
  EXPECT_EQ(error.byte, byte) << error.what();
}

using Face = std::vector<std::uint32_t>;
inline std::vector<Face> faces_of(const PolygonMesh& mesh) {
  std::vector<Face> faces;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    Face& face = faces.emplace_back();
    for (const VertexId v : mesh.face(FaceId(f))) face.push_back(v.value);
  }
  return faces;
}

inline std::vector<std::string> label_of_faces(const LabelSet& labels) {
  std::vector<std::string> names;
  for (const std::uint32_t label : labels.of_face) names.push_back(labels.names.at(label));
  return names;
}

/// Returns `text` with another line end in place of `\n`.
inline std::string with_line_end(const std::string& line_end, std::string_view text) {
  std::string result;
  for (const char c : text) c == '\n' ? result.append(line_end) : result.append(1, c);
  return result;
}

}  // namespace remesh::test
