#include "api/multipart.h"

#include "api/file_name.h"
#include "api/quoting.h"
#include "api/request_code.h"
#include "core/base/error.h"

namespace remesh::api {
namespace {

constexpr std::size_t kMaxParts = 64;  // one for each option, and some files
constexpr std::size_t kMaxHeadBytes = 8192;
constexpr std::size_t kMaxBoundary = 70;  // RFC 2046, 5.1.1
constexpr std::string_view kLineEnd = "\r\n";

[[noreturn]] void fail(const std::string& message) {
  throw Error(as_code(RequestCode::kMalformedMultipart), Stage::kRead, "multipart/form-data: " + message);
}

/// Reads a quoted string from `rest`, which begins after the opening quote.
/// Output: nothing if the string has no end.
std::optional<std::string> take_quoted(std::string_view& rest) {
  std::string text;
  while (!rest.empty()) {
    char c = rest.front();
    rest.remove_prefix(1);
    if (c == '"') return text;
    // Only quotes are unescaped, because old browsers send the backslashes of a path as they are.
    if (c == '\\' && rest.starts_with('"')) {
      c = '"';
      rest.remove_prefix(1);
    }
    text += c;
  }
  return std::nullopt;
}

std::string boundary_of(std::string_view content_type) {
  const std::optional<std::string> boundary = header_parameter(content_type, "boundary");
  if (!boundary || boundary->empty()) fail("the Content-Type has no boundary");
  if (boundary->size() > kMaxBoundary) fail("the boundary is longer than 70 characters");
  return *boundary;
}

void read_part_header(std::string_view line, FormPart& part) {
  const auto [raw_name, raw_value] = cut(line, ':');
  const std::string name = ascii_lower(raw_name);
  const std::string_view value = trim(raw_value);
  if (name.empty() || raw_name.size() == line.size() || name.find_first_of(" \t") != std::string::npos) {
    fail("a part has a malformed header: " + in_quotes(line));
  }
  if (name == "content-disposition") {
    if (!part.name.empty()) fail("a part has two Content-Disposition headers");
    if (ascii_lower(trim(cut(value, ';').first)) != "form-data") fail("a part is not form-data");
    part.name = header_parameter(value, "name").value_or("");
    const auto file_name = header_parameter(value, "filename");
    part.is_file = file_name.has_value();
    part.file_name = file_name.value_or("");
    // Forms should not have it (RFC 7578, section 4.2), but some clients send nothing else for names beyond ASCII.
    if (const auto extended = header_parameter(value, "filename*")) {
      part.is_file = true;
      if (std::string name = decode_extended_value(*extended); !name.empty()) part.file_name = std::move(name);
    }
  } else if (name == "content-type") {
    part.content_type = value;
  } else if (name == "content-transfer-encoding") {
    const std::string encoding = ascii_lower(value);
    if (encoding != "binary" && encoding != "8bit" && encoding != "7bit") {
      fail("the encoding " + in_quotes(value) + " of a part is not supported");
    }
  }
}

/// Reads the headers of a part and the blank line after them from `rest`.
FormPart read_part_head(std::string_view& rest) {
  FormPart part;
  std::size_t bytes = 0;
  for (;;) {
    const std::size_t end = rest.substr(0, kMaxHeadBytes + 1 - bytes).find(kLineEnd);
    if (end == std::string_view::npos) fail("the headers of a part do not end, or are longer than 8192 bytes");
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(end + kLineEnd.size());
    bytes += end + kLineEnd.size();
    if (line.empty()) break;
    read_part_header(line, part);
    if (bytes > kMaxHeadBytes) fail("the headers of a part are longer than 8192 bytes");
  }
  if (part.name.empty()) fail("a part has no name");
  return part;
}

}  // namespace

std::optional<std::string> header_parameter(std::string_view value, std::string_view name) {
  std::string_view rest = cut(value, ';').second;
  while (!rest.empty()) {
    const std::size_t end_of_name = rest.find_first_of("=;");
    if (end_of_name == std::string_view::npos) return std::nullopt;
    const std::string found = ascii_lower(trim(rest.substr(0, end_of_name)));
    const bool has_value = rest[end_of_name] == '=';
    rest.remove_prefix(end_of_name + 1);
    if (!has_value) continue;

    std::string text;
    while (!rest.empty() && is_blank(rest.front())) rest.remove_prefix(1);
    if (rest.starts_with('"')) {
      rest.remove_prefix(1);
      std::optional<std::string> quoted_text = take_quoted(rest);
      if (!quoted_text) return std::nullopt;
      text = std::move(*quoted_text);
      rest = cut(rest, ';').second;
    } else {
      const auto [token, after] = cut(rest, ';');
      text = trim(token);
      rest = after;
    }
    if (found == name) return text;
  }
  return std::nullopt;
}

std::vector<FormPart> parse_multipart(std::string_view body, std::string_view content_type) {
  const std::string dash_boundary = "--" + boundary_of(content_type);
  const std::string delimiter = std::string(kLineEnd) + dash_boundary;

  // Text before the first delimiter must be ignored. The first delimiter need not follow a line end.
  std::string_view rest = body;
  if (!rest.starts_with(dash_boundary)) {
    const std::size_t first = rest.find(delimiter);
    if (first == std::string_view::npos) fail("the boundary does not occur in the body");
    rest.remove_prefix(first + kLineEnd.size());
  }
  rest.remove_prefix(dash_boundary.size());

  std::vector<FormPart> parts;
  while (!rest.starts_with("--")) {
    while (!rest.empty() && is_blank(rest.front())) rest.remove_prefix(1);
    if (!rest.starts_with(kLineEnd)) fail("a boundary is not followed by a line end");
    rest.remove_prefix(kLineEnd.size());
    if (parts.size() == kMaxParts) fail("more than 64 parts");

    FormPart part = read_part_head(rest);
    const std::size_t end = rest.find(delimiter);
    if (end == std::string_view::npos) fail("the last part does not end");
    part.content = rest.substr(0, end);
    rest.remove_prefix(end + delimiter.size());
    parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace remesh::api
