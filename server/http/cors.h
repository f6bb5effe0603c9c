/// Which pages of other sites may use the daemon from a browser (CORS, in the Fetch standard).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "server/http/http_message.h"

namespace remesh::server {

class Cors {
 public:
  /// Permits no page.
  Cors() = default;
  /// Permits the pages of the listed origins.
  /// Input: `origins` - separated by commas, such as `https://tool.example:8443`; `*` permits all.
  /// Errors: std::invalid_argument - an element is not an origin.
  explicit Cors(std::string_view origins);

  /// True if pages of this origin may use the daemon.
  bool allows(std::string_view origin) const;
  /// Makes the header fields that the answer to this request needs.
  /// Input: `allow` - for a preflight, the methods of the path; the fields then include the permission.
  Fields headers(const RequestHead& head, std::string_view allow = {}) const;

  std::string text() const;

 private:
  std::vector<std::string> origins_;
};

}  // namespace remesh::server
