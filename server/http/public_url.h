/// The URL under which clients reach the daemon, if a proxy stands in front of it (--public-url).
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "server/http/host_name.h"

namespace remesh::server {

class PublicUrl {
 public:
  /// No URL is known.
  PublicUrl() = default;
  /// Input:  such as `https://mesh.example.org` or `https://example.org/mesh`, where the path is a prefix that the
  ///         proxy removes.
  /// Errors: std::invalid_argument - not an http or https URL, or one with a query or characters that need escapes.
  explicit PublicUrl(std::string_view text);

  const std::optional<Origin>& origin() const { return origin_; }
  /// The prefix of all paths, such as `/mesh`; empty if there is none.
  const std::string& prefix() const { return prefix_; }
  std::string text() const { return text_.empty() ? "none" : text_; }

 private:
  std::string text_;
  std::optional<Origin> origin_;
  std::string prefix_;
};

/// True if the text may stand before all paths of this daemon: `/`, then letters, digits and `-._~/`, without an
/// empty segment and without a final slash.
bool is_path_prefix(std::string_view text);

}  // namespace remesh::server
