/// Which pages of other sites may use the daemon from a browser (the Fetch standard's CORS).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "server/http/http_message.h"

namespace remesh::server {

class Cors {
 public:
  /// No page may.
  Cors() = default;
  /// Those of a comma-separated list of origins, such as `https://tool.example:8443`, may; of `*`, all.
  /// Errors: std::invalid_argument - an element that is no origin.
  explicit Cors(std::string_view origins);

  /// The fields that the answer to this request needs; for a preflight (`allow`: the methods of the path) those of a
  /// permission, too.
  Fields headers(const RequestHead& head, std::string_view allow = {}) const;

  std::string text() const;

 private:
  std::vector<std::string> origins_;
};

}  // namespace remesh::server
