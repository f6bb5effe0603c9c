// The head of a request on any bytes, whole and in pieces: the same either way, and never more than the limits.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "server/http/request_head.h"
#include "server/observe/trace_context.h"
#include "tests/fuzz/fuzz.h"

namespace remesh::fuzz {
namespace {

using server::HttpError;

const server::HeadLimits kLimits{1024, 20};

/// The length of the head as it is found in steps of `step` bytes; 0: refused, nothing: not there yet.
std::optional<std::size_t> head_end(std::string_view bytes, std::size_t step) {
  std::size_t checked = 0;
  try {
    for (std::size_t have = std::min(step, bytes.size());; have = std::min(have + step, bytes.size())) {
      if (const auto end = server::find_head_end(bytes.substr(0, have), checked, kLimits)) return end;
      if (have == bytes.size()) return std::nullopt;
    }
  } catch (const HttpError& error) {
    require(error.problem.status >= 400 && error.problem.status < 500, "a head is refused as a fault of the server");
    return 0;
  }
}

void check_head(const server::RequestHead& head) {
  require(!head.path.empty() && (head.path.front() == '/' || head.path == "*"), "a path that is none");
  require(head.path.find('\0') == std::string::npos, "a NUL in a path");
  require(head.headers.size() <= kLimits.max_fields, "too many fields");
  for (const auto& [name, value] : head.headers) {
    require(!name.empty(), "a field without a name");
    require(value.find_first_of(std::string_view("\r\n\0", 3)) == std::string::npos, "a field that breaks its line");
  }
  server::parse_traceparent(head.header("traceparent"));
  server::framing(head);
}

}  // namespace
}  // namespace remesh::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace remesh;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  if (bytes.empty()) return 0;
  const auto end = fuzz::head_end(bytes, bytes.size());
  fuzz::require(end == fuzz::head_end(bytes, 1), "a head depends on how it arrives");
  if (end.value_or(0) == 0) return 0;
  try {
    server::RequestHead head;
    server::parse_head(bytes.substr(0, *end), fuzz::kLimits, head);
    fuzz::check_head(head);
  } catch (const server::HttpError& error) {
    const int status = error.problem.status;
    fuzz::require(status == 400 || status == 411 || status == 431 || status == 501, "a status that a head has not");
  }
  return 0;
}
