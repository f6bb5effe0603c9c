/// The address of the client of a request, which a proxy in front of the daemon reports.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "server/http/http_message.h"

namespace remesh::server {

/// The proxies whose information about their clients is trusted (--trusted-proxies).
class TrustedProxies {
 public:
  /// Trusts no proxy.
  TrustedProxies() = default;
  /// Input:  addresses and networks, separated by commas, such as `127.0.0.1, 10.0.0.0/8, fd00::/8`.
  /// Errors: std::invalid_argument - an element is neither an address nor a network.
  explicit TrustedProxies(std::string_view addresses);

  /// Input: `address` - a numeric address; any other text is never trusted.
  bool contains(std::string_view address) const;
  std::string text() const;

 private:
  struct Network {
    std::array<std::uint8_t, 16> bits;  ///< an IPv4 address stands here as it is mapped to IPv6
    int length;                         ///< the number of leading bits that count
    std::string text;
  };

  std::vector<Network> networks_;
};

/// Finds the client of a request. If the peer is a trusted proxy, that is the last address in `X-Forwarded-For`, or in
/// `Forwarded` (RFC 7239) if there is no `X-Forwarded-For`, that is no trusted proxy itself. Addresses before that one
/// can be forged.
/// Input:  `peer` - the address of the other end of the connection.
/// Output: a numeric address without a port; the peer if it is not trusted or names no client.
std::string client_address(const RequestHead& head, const std::string& peer, const TrustedProxies& proxies);

/// True if a trusted proxy says that a request comes from a client whose address it does not tell, such as `unknown`.
bool is_client_hidden(const RequestHead& head, const std::string& peer, const TrustedProxies& proxies);

}  // namespace remesh::server
