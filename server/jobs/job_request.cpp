#include "server/jobs/job_request.h"

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "api/json_writer.h"

namespace remesh::server::jobs {

std::string pack_request(const api::Request& request) {
  api::JsonWriter json;
  json.begin_object();
  json.member("content_type", request.content_type);
  json.member("content_encoding", request.content_encoding);
  json.member("accept", request.accept);
  json.key("query");
  json.begin_array();
  for (const auto& [name, value] : request.query) {
    json.begin_array();
    json.string(name);
    json.string(value);
    json.end_array();
  }
  json.end_array();
  json.end_object();
  return json.take();
}

api::Request unpack_request(std::string_view text) {
  const auto json = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object()) throw std::runtime_error("a kept request is damaged");
  api::Request request;
  request.content_type = json.value("content_type", "");
  request.content_encoding = json.value("content_encoding", "");
  request.accept = json.value("accept", "");
  for (const auto& option : json.at("query")) request.query.emplace_back(option.at(0), option.at(1));
  return request;
}

}  // namespace remesh::server::jobs
