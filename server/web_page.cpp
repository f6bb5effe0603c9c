#include "server/web_page.h"

#include <string>

#include "core/io/gzip.h"
#include "server/http/content_coding.h"
#include "server/http/digest.h"
#include "server/http/partial_content.h"

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
  if (names_tag(request.list("if-none-match"), tag)) {
    response.status = 304;
    return response;
  }
  response.content_type = file.type;
  if (!file.is_packed) {
    response.body = file.bytes;
  } else if (accepts_gzip(request.list("accept-encoding"))) {
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
         Access::kPageFile});
  }
  return routes;
}

}  // namespace remesh::server
