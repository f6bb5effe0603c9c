#include "api/multipart.h"

#include <gtest/gtest.h>

#include "api/request_code.h"
#include "core/base/error.h"

namespace remesh::api {
namespace {

constexpr std::string_view kType = "multipart/form-data; boundary=XX";
const std::string kMeshHead =
    "Content-Disposition: form-data; name=\"mesh\"; filename=\"part.obj\"\r\nContent-Type: model/obj\r\n\r\n";
const std::string kBody =
    "--XX\r\n" + kMeshHead +
    "v 0 0 0\r\n--X\r\n\r\n--XX\r\nContent-Disposition: form-data; name=options\r\n\r\n{}\r\n--XX--\r\n";

void expect_malformed(std::string_view body, std::string_view type = kType) {
  try {
    parse_multipart(body, type);
    ADD_FAILURE() << "no error for " << body;
  } catch (const Error& error) {
    EXPECT_EQ(error.code, RequestCode::kMalformedMultipart);
  }
}

TEST(multipart, parts_are_taken_apart_with_their_bytes_untouched) {
  const std::vector<FormPart> parts = parse_multipart(kBody, kType);
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0].name, "mesh");
  EXPECT_EQ(parts[0].file_name, "part.obj");
  EXPECT_EQ(parts[0].content_type, "model/obj");
  EXPECT_EQ(parts[0].content, "v 0 0 0\r\n--X\r\n");
  EXPECT_EQ(parts[1].name, "options");
  EXPECT_EQ(parts[1].content, "{}");
  EXPECT_EQ(parts[1].content_type, "");
}

TEST(multipart, a_preamble_and_an_epilogue_are_ignored) {
  EXPECT_EQ(parse_multipart("to be ignored\r\n" + kBody + "and this", kType).size(), 2u);
}

TEST(multipart, an_empty_part_is_empty) {
  const std::vector<FormPart> parts = parse_multipart("--XX\r\n" + kMeshHead + "\r\n--XX--", kType);
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(parts[0].content, "");
}

TEST(multipart, any_bytes_may_be_in_a_part) {
  std::string bytes;
  for (int i = 0; i < 256; ++i) bytes += static_cast<char>(i);
  bytes += "\r\n--X\r\n-\r\n--Y";
  const std::string body = "--XX\r\n" + kMeshHead + bytes + "\r\n--XX--";
  const std::vector<FormPart> parts = parse_multipart(body, kType);
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(parts[0].content, bytes);
}

TEST(multipart, a_boundary_may_be_quoted) {
  EXPECT_EQ(
      parse_multipart("--a;b\r\n" + kMeshHead + "x\r\n--a;b--", "Multipart/Form-Data; charset=x; Boundary=\"a;b\"")
          .size(),
      1u);
}

TEST(multipart, a_bad_boundary_is_refused) {
  for (const std::string_view type : {"multipart/form-data", "multipart/form-data; boundary=",
                                      "multipart/form-data; boundary=\"X", "multipart/form-data; boundary"}) {
    expect_malformed(kBody, type);
  }
  expect_malformed(kBody, "multipart/form-data; boundary=" + std::string(71, 'X'));
  expect_malformed(kBody, "multipart/form-data; boundary=YY");
}

TEST(multipart, every_truncation_is_refused) {
  const std::size_t whole = kBody.size() - 2;  // the last line end may be missing
  for (std::size_t length = 0; length < whole; ++length) expect_malformed(std::string_view(kBody).substr(0, length));
  EXPECT_EQ(parse_multipart(std::string_view(kBody).substr(0, whole), kType).size(), 2u);
}

TEST(multipart, what_is_not_allowed_is_refused) {
  const auto part = [](const std::string& head) { return "--XX\r\n" + head + "\r\nx\r\n--XX--\r\n"; };
  expect_malformed(part(""));
  expect_malformed(part("Content-Type: model/obj\r\n"));
  expect_malformed(part("Content-Disposition: form-data\r\n"));
  expect_malformed(part("Content-Disposition: attachment; name=mesh\r\n"));
  expect_malformed(part("Content-Disposition: form-data; name=mesh\r\nno colon\r\n"));
  expect_malformed(part("Content-Disposition: form-data; name=mesh\r\n folded\r\n"));
  expect_malformed(
      part("Content-Disposition: form-data; name=mesh\r\nContent-Disposition: form-data; name=options\r\n"));
  expect_malformed(part("Content-Disposition: form-data; name=mesh\r\nContent-Transfer-Encoding: base64\r\n"));
  expect_malformed(part("Content-Disposition: form-data; name=mesh\r\nX: " + std::string(9000, 'a') + "\r\n"));
  EXPECT_EQ(
      parse_multipart(part("Content-Disposition: form-data; name=mesh\r\nContent-Transfer-Encoding: BINARY\r\n"), kType)
          .size(),
      1u);
}

TEST(multipart, parts_are_bounded) {
  std::string body;
  for (int i = 0; i < 65; ++i) body += "--XX\r\nContent-Disposition: form-data; name=a\r\n\r\nx\r\n";
  expect_malformed(body + "--XX--");
}

TEST(header_parameter, quotes_semicolons_and_backslashes_are_kept_apart) {
  const std::string_view value = R"(form-data; name="a;b"; filename="C:\temp\x\"y.obj" ; other=1)";
  EXPECT_EQ(header_parameter(value, "name"), "a;b");
  EXPECT_EQ(header_parameter(value, "filename"), R"(C:\temp\x"y.obj)");
  EXPECT_EQ(header_parameter(value, "other"), "1");
  EXPECT_EQ(header_parameter(value, "none"), std::nullopt);
}

}  // namespace
}  // namespace remesh::api
