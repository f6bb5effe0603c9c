#include "api/cli/failure.h"

#include <gtest/gtest.h>

#include <new>
#include <stdexcept>

#include "api/cli/files.h"
#include "api/cli/remote.h"

namespace remesh::cli {
namespace {

template <typename T>
Failure failure_by(const T& thrown, const std::string& input = "part.obj") {
  return failure_of(std::make_exception_ptr(thrown), input);
}

Error bad_index() { return Error(Code::kIndexOutOfRange, Stage::kRead, "no such vertex"); }

TEST(failure, the_place_is_the_line_or_the_byte_of_the_input) {
  EXPECT_EQ(place_of(bad_index().at_line(12), "part.obj"), "part.obj:12");
  EXPECT_EQ(place_of(bad_index().at_byte(84), "part.stl"), "part.stl: byte 84");
  EXPECT_EQ(place_of(bad_index(), "part.obj"), "part.obj");
  EXPECT_EQ(place_of(bad_index().at_line(3), "-"), "standard input:3");
}

TEST(failure, what_the_mesh_decides_fails_and_what_the_command_line_decides_is_misuse) {
  EXPECT_EQ(exit_code(bad_index()), kFailed);
  EXPECT_EQ(exit_code(Error(Code::kInvalidOption, Stage::kRead, "").for_option("max_area")), kMisused);
  EXPECT_EQ(exit_code(Error(Code::kNotAcceptable, Stage::kRead, "")), kMisused);
  // The option is named, but the fault is the mesh's, because the mesh does not keep to the option.
  EXPECT_EQ(exit_code(Error(Code::kOutputTooLarge, Stage::kRefinement, "").for_option("max_output_faces")), kFailed);
  EXPECT_EQ(exit_code(Error(Code::kCancelled, Stage::kWeld, "")), kFailed);
}

TEST(failure, only_an_error_of_reading_names_the_input) {
  EXPECT_EQ(describe(bad_index().at_line(12), "part.obj"), "part.obj:12: index_out_of_range: no such vertex");
  EXPECT_EQ(describe(Error(Code::kVerificationFailed, Stage::kVerify, "a hole"), "part.obj"),
            "verification_failed: a hole");
  EXPECT_EQ(describe(Error(Code::kInvalidOption, Stage::kRead, "below 0").for_option("max_area"), "part.obj"),
            "invalid_option: below 0");
}

TEST(failure, whatever_is_thrown_has_a_code_and_a_line) {
  const Failure read = failure_by(bad_index().at_line(2));
  EXPECT_EQ(read.code, "index_out_of_range");
  EXPECT_EQ(read.message, "no such vertex");
  EXPECT_EQ(read.line, "part.obj:2: index_out_of_range: no such vertex");

  const Failure file = failure_by(FileError("out.obj: No space left on device"));
  EXPECT_EQ(file.code, "file_error");
  EXPECT_EQ(file.line, "out.obj: No space left on device");

  EXPECT_EQ(failure_by(std::bad_alloc()).code, "out_of_memory");
  EXPECT_EQ(failure_by(std::runtime_error("odd")).line, "internal: odd");
  EXPECT_EQ(failure_by(42).code, "internal");
  for (const Failure& failure : {read, file, failure_by(std::bad_alloc()), failure_by(42)}) {
    EXPECT_EQ(failure.exit_code, kFailed) << failure.line;
  }
}

TEST(failure, a_servers_refusal_is_told_as_our_own_would_be) {
  RemoteError mesh(422, "index_out_of_range", "no such vertex");
  mesh.line = 7;
  EXPECT_EQ(failure_by(mesh).line, "part.obj:7: index_out_of_range: no such vertex");
  EXPECT_EQ(failure_by(mesh).exit_code, kFailed);
  const Failure option = failure_by(RemoteError(400, "invalid_option", "below 0"));
  EXPECT_EQ(option.line, "invalid_option: below 0");
  EXPECT_EQ(option.exit_code, kMisused);
  EXPECT_EQ(failure_by(RemoteError(406, "not_acceptable", "")).exit_code, kMisused);
  EXPECT_EQ(failure_by(RemoteError(0, "server_unreachable", "")).exit_code, kFailed);
}

}  // namespace
}  // namespace remesh::cli
