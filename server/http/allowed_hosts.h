/// The names that a daemon without an API key answers to, besides its addresses and localhost (--allowed-hosts).
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace remesh::server {

class AllowedHosts {
 public:
  /// Allows no further name.
  AllowedHosts() = default;
  /// Input: `names` - DNS names without ports, separated by commas; `*` allows every name.
  /// Errors: std::invalid_argument - an element is no name.
  explicit AllowedHosts(std::string_view names);

  /// Input: `name` - in lower case, as in Host.
  bool allows(std::string_view name) const;
  std::string text() const;

 private:
  std::vector<std::string> names_;
};

}  // namespace remesh::server
