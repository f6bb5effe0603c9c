#include "server/web_page.h"

#include <string>
#include <utility>

#include "core/io/gzip.h"
#include "server/http/content_coding.h"
#include "server/http/digest.h"
#include "server/http/text.h"

namespace remesh::server {
namespace {

/// Forbids inline scripts, resources from elsewhere, and frames around the page. Pictures that the page makes itself
/// are data or blob URLs.
constexpr const char* kContentSecurityPolicy =
    "default-src 'none'; script-src 'self'; worker-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
constexpr const char* kForEver = "public, max-age=31536000, immutable";
constexpr const char* kAskEachTime = "no-cache";

/// Makes a weak entity tag, because the packed and the unpacked bytes share it.
std::string entity_tag(std::string_view bytes) {
  const std::string digest = repr_digest(bytes);
  return "W/\"" + digest.substr(digest.find(':') + 1, 22) + "\"";
}

/// True if an `If-None-Match` field names the tag (RFC 9110, section 13.1.2: weak comparison).
bool names_tag(std::string_view field, std::string_view tag) {
  const auto opaque = [](std::string_view t) { return t.substr(t.starts_with("W/") ? 2 : 0); };
  for (const std::string_view element : list_elements(field)) {
    if (element == "*" || opaque(element) == opaque(tag)) return true;
  }
  return false;
}

std::string unpacked(std::string_view bytes) {
  RunControl control;
  return gunzip(bytes, DecompressionLimits{}, control);
}

Response answer(const WebFile& file, const std::string& tag, const Request& request) {
  Response response;
  response.headers = {{"ETag", tag},
                      {"Cache-Control", file.is_fixed ? kForEver : kAskEachTime},
                      {"Vary", "Accept-Encoding"},
                      {"Content-Security-Policy", kContentSecurityPolicy},
                      {"Cross-Origin-Opener-Policy", "same-origin"},
                      {"Cross-Origin-Resource-Policy", "same-origin"},
                      {"Referrer-Policy", "no-referrer"}};
  if (names_tag(request.header("if-none-match"), tag)) {
    response.status = 304;
    return response;
  }
  response.content_type = file.type;
  if (!file.is_packed) {
    response.body = file.bytes;
  } else if (accepts_gzip(request.header("accept-encoding"))) {
    response.body = file.bytes;
    response.headers.emplace_back("Content-Encoding", "gzip");
  } else {
    response.body = unpacked(file.bytes);
  }
  return response;
}

}  // namespace

std::vector<Route> web_routes(const std::vector<WebFile>& files) {
  std::vector<Route> routes;
  routes.reserve(files.size());
  for (const WebFile& file : files) {
    routes.push_back(
        {"GET", std::string(file.path),
         [file, tag = entity_tag(file.bytes)](const Call& call) { return answer(file, tag, call.request); }, nullptr,
         /*is_open=*/true});
  }
  return routes;
}

}  // namespace remesh::server
