#include "server/jobs/job_request.h"

#include <array>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "api/json_writer.h"
#include "api/multipart.h"
#include "api/negotiation.h"
#include "api/quoting.h"
#include "server/http/digest.h"

namespace remesh::server::jobs {
namespace {

constexpr const char* kForm = "multipart/form-data";

/// True if the parts of a form can be read. A form that is compressed as a whole cannot, and its digest depends on
/// the boundary.
bool is_plain_form(const api::Request& request) {
  const std::string coding = api::ascii_lower(trim(request.content_encoding));
  return api::media_type_of(request.content_type) == kForm && (coding.empty() || coding == "identity");
}

std::string describe_parts(const api::Request& request) {
  api::JsonWriter json;
  json.list(api::parse_multipart(request.body, request.content_type), [&](const api::FormPart& part) {
    json.object([&] {
      json.member("name", part.name);
      json.member("file_name", part.file_name);
      json.member("content_type", part.content_type);
      json.member("content", hex(sha256(part.content)));
    });
  });
  return json.take();
}

}  // namespace

std::string pack_request(const api::Request& request) {
  api::JsonWriter json;
  json.object([&] {
    json.member("content_type", request.content_type);
    json.member("content_encoding", request.content_encoding);
    json.member("accept", request.accept);
    json.list("query", request.query, [&](const auto& option) {
      json.list(std::array{option.first, option.second}, [&](const std::string& text) { json.string(text); });
    });
  });
  return json.take();
}

api::Request unpack_request(std::string_view text) {
  const auto json = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object()) throw std::runtime_error("a stored request is damaged");
  api::Request request;
  request.content_type = json.value("content_type", "");
  request.content_encoding = json.value("content_encoding", "");
  request.accept = json.value("accept", "");
  for (const auto& option : json.at("query")) request.query.emplace_back(option.at(0), option.at(1));
  return request;
}

std::string request_digest(const api::Request& request) {
  if (!is_plain_form(request)) return hex(sha256(pack_request(request) + "\n" + hex(sha256(request.body))));
  api::Request form = request;
  form.content_type = kForm;
  return hex(sha256(pack_request(form) + "\n" + describe_parts(request)));
}

}  // namespace remesh::server::jobs
