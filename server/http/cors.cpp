#include "server/http/cors.h"

#include <algorithm>
#include <stdexcept>

#include "server/http/header_lists.h"
#include "server/http/host_name.h"

namespace remesh::server {
namespace {

constexpr const char* kAnyOrigin = "*";

}  // namespace

Cors::Cors(std::string_view origins) {
  for (const std::string_view origin : list_elements(origins)) {
    if (origin != kAnyOrigin && !parse_origin(origin)) {
      throw std::invalid_argument("\"" + std::string(origin) + "\" is not an origin, such as https://tool.example");
    }
    origins_.emplace_back(origin);
  }
}

bool Cors::allows(std::string_view origin) const {
  return std::any_of(origins_.begin(), origins_.end(),
                     [&](const std::string& o) { return o == kAnyOrigin || o == origin; });
}

Fields Cors::headers(const RequestHead& head, std::string_view allow) const {
  if (origins_.empty()) return {};
  const bool is_any = std::find(origins_.begin(), origins_.end(), kAnyOrigin) != origins_.end();
  Fields fields;
  // Caches must not reuse the answer for one origin for another origin.
  if (!is_any) fields.emplace_back("Vary", "Origin");
  const std::string_view origin = head.header("origin");
  if (origin.empty()) return fields;
  if (!allows(origin)) return fields;
  fields.emplace_back("Access-Control-Allow-Origin", is_any ? kAnyOrigin : origin);
  if (allow.empty() || head.header("access-control-request-method").empty()) {
    fields.emplace_back("Access-Control-Expose-Headers",
                        "Accept-Ranges, Content-Disposition, Content-Range, ETag, Location, Remesh-Summary, "
                        "Repr-Digest, Retry-After, Server-Timing, "
                        "X-Request-Id");
    return fields;
  }
  fields.emplace_back("Access-Control-Allow-Methods", allow);
  fields.emplace_back(
      "Access-Control-Allow-Headers",
      "Authorization, Content-Encoding, Content-Type, Idempotency-Key, If-None-Match, If-Range, Last-Event-ID, Prefer, "
      "Range, "
      "Traceparent, X-API-Key, X-Request-Id");
  fields.emplace_back("Access-Control-Max-Age", "600");
  return fields;
}

std::string Cors::text() const {
  std::string text;
  for (const std::string& origin : origins_) text += (text.empty() ? "" : ",") + origin;
  return text.empty() ? "none" : text;
}

}  // namespace remesh::server
