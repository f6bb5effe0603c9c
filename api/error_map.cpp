// The only table that maps the codes of errors to HTTP, and the writer of problem+json.
#include "api/json_writer.h"
#include "api/operations.h"
#include "api/request_code.h"

namespace remesh::api {
namespace {

int status_of(Code code) {
  switch (code) {
    case Code::kInvalidOption: return 400;
    case Code::kNotAcceptable: return 406;
    case Code::kMeshTooLarge:
    case Code::kDecompressedTooLarge:
    // The memory bound depends on the mesh alone, so another attempt would fail as well.
    case Code::kOutOfMemory: return 413;
    case Code::kUnsupportedMediaType: return 415;
    case Code::kInvalidMesh:
    case Code::kIndexOutOfRange:
    case Code::kNonfiniteCoordinate:
    case Code::kCoordinateRange:
    case Code::kEmptyMesh:
    case Code::kOutputTooLarge: return 422;
    case Code::kCancelled: return 499;
    case Code::kVerificationFailed:
    case Code::kInternal: return 500;
    case Code::kTimeout: return 504;
  }
  return 500;
}

int status_of(RequestCode code) {
  switch (code) {
    case RequestCode::kMalformedRequest:
    case RequestCode::kMalformedJson:
    case RequestCode::kMalformedMultipart:
    case RequestCode::kUnknownOption: return 400;
    case RequestCode::kBodyTooLarge: return 413;
  }
  return 500;
}

std::string_view name_of(RequestCode code) {
  switch (code) {
    case RequestCode::kMalformedRequest: return "malformed_request";
    case RequestCode::kMalformedJson: return "malformed_json";
    case RequestCode::kMalformedMultipart: return "malformed_multipart";
    case RequestCode::kBodyTooLarge: return "body_too_large";
    case RequestCode::kUnknownOption: return "unknown_option";
  }
  return "internal";
}

/// The code of an error that only a request has; nothing for an error of the core.
std::optional<RequestCode> request_code(const Error& error) {
  if (static_cast<int>(error.code) < kCoreCodeCount) return std::nullopt;
  return static_cast<RequestCode>(error.code);
}

/// Makes a title from a code: "index_out_of_range" becomes "Index out of range".
std::string title_of(std::string_view code) {
  std::string title(code);
  for (char& c : title) {
    if (c == '_') c = ' ';
  }
  if (!title.empty() && title[0] >= 'a' && title[0] <= 'z') title[0] = static_cast<char>(title[0] - 'a' + 'A');
  return title;
}

}  // namespace

std::string_view error_name(const Error& error) {
  const std::optional<RequestCode> code = request_code(error);
  return code ? name_of(*code) : code_name(error.code);
}

Problem to_problem(const Error& error) {
  const std::optional<RequestCode> code = request_code(error);
  Problem problem;
  problem.status = code ? status_of(*code) : status_of(error.code);
  problem.code = error_name(error);
  problem.detail = error.what();
  problem.line = error.line;
  problem.byte = error.byte;
  problem.element = error.element;
  problem.limit = error.limit;
  // An empty name is the name of an unknown option, too. So the name of an unknown option is told even if it is empty.
  if (!error.option.empty() || error.code == RequestCode::kUnknownOption) problem.option = error.option;
  if (error.code == Code::kInternal)
    problem.detail = "an internal error has occurred; the server's log has the details under this request id";
  return problem;
}

Response to_response(const Problem& problem, std::string_view request_id) {
  JsonWriter json;
  const auto if_known = [&](std::string_view name, const std::optional<std::uint64_t>& value) {
    if (value) json.member(name, *value);
  };
  json.begin_object();
  json.member("type", "urn:remeshd:problem:" + problem.code);
  json.member("title", title_of(problem.code));
  json.member("status", static_cast<std::uint64_t>(problem.status));
  json.member("detail", problem.detail);
  json.member("code", problem.code);
  if (!request_id.empty()) json.member("request_id", request_id);
  if_known("line", problem.line);
  if_known("byte", problem.byte);
  if_known("element", problem.element);
  if (problem.option) json.member("option", *problem.option);
  if_known("limit", problem.limit);
  json.end_object();

  Response response;
  response.status = problem.status;
  response.content_type = "application/problem+json";
  response.body = json.take() + "\n";
  return response;
}

}  // namespace remesh::api
