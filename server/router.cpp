#include "server/router.h"

#include <optional>

namespace remesh::server {
namespace {

/// Output: what stands for the parameter (empty if there is none), or nothing when the path does not match.
std::optional<std::string> match(std::string_view pattern, std::string_view path) {
  std::string parameter;
  while (!pattern.empty() && !path.empty()) {
    // Both start with a slash; compare up to the next one.
    const std::string_view expected = pattern.substr(0, pattern.find('/', 1));
    const std::string_view segment = path.substr(0, path.find('/', 1));
    if (expected == "/{id}" && segment.size() > 1) {
      parameter = segment.substr(1);
    } else if (expected != segment) {
      return std::nullopt;
    }
    pattern.remove_prefix(expected.size());
    path.remove_prefix(segment.size());
  }
  if (!pattern.empty() || !path.empty()) return std::nullopt;
  return parameter;
}

}  // namespace

std::uint64_t Router::admit(const RequestHead& head) const {
  const Match found = find(head);
  return found.route != nullptr && found.route->admit ? found.route->admit() : 0;
}

Response Router::answer(Request& request, Connection& connection) const {
  const Match found = find(request);
  if (found.route != nullptr) return found.route->handle({request, connection, found.parameter});
  Response response;
  response.status = 204;
  response.headers.emplace_back("Allow", found.allow);
  return response;
}

Router::Match Router::find(const RequestHead& head) const {
  std::string allow;
  for (const Route& route : routes_) {
    const std::optional<std::string> parameter = match(route.path, head.path);
    if (!parameter) continue;
    if (head.method == route.method || (head.method == "HEAD" && route.method == "GET"))
      return {&route, *parameter, ""};
    allow += route.method == "GET" ? "GET, HEAD, " : route.method + ", ";
  }
  if (allow.empty() && head.path != "*") throw HttpError(404, "not_found", "there is nothing at this path");
  allow += "OPTIONS";
  if (head.method == "OPTIONS") return {nullptr, "", allow};
  throw HttpError(405, "method_not_allowed", "this path takes " + allow).with_header("Allow", allow);
}

}  // namespace remesh::server
