/// The hosts that requests and pages name: of the Host field, of an absolute target, and of an origin.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace remesh::server {

struct Host {
  std::string name;  ///< in lower case, without a final dot; an IPv6 address keeps its brackets
  std::string port;  ///< empty if none is named
};

/// Splits `name:port`. Any text is accepted, because the caller decides by the name whether a host is permitted.
Host parse_host(std::string_view text);

enum class HostKind {
  kNone,       ///< no host is named, as HTTP/1.0 permits; browsers always name one
  kAddress,    ///< a number that no name server can redirect
  kLocalhost,  ///< `localhost`, or a name below it, which browsers never ask a name server for
  kDotless,    ///< the name of a machine or a service of this network
  kMalformed,  ///< no host: brackets around no IPv6 address or with a text beside them, or a port that is no number
  kDomain,     ///< a name with a dot, whose owner decides which address it leads to
};
HostKind kind_of(const Host& host);

/// The origin of a page (RFC 6454).
struct Origin {
  std::string scheme;  ///< in lower case
  Host host;
};
/// Output: nothing if the text is no origin, such as `null`.
std::optional<Origin> parse_origin(std::string_view text);

/// True if both name the same host and port. A port that is missing is the standard one of the origin's scheme.
bool is_at(const Origin& origin, const Host& host);

}  // namespace remesh::server
