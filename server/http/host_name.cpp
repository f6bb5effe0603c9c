#include "server/http/host_name.h"

#include <arpa/inet.h>

#include <algorithm>

#include "api/quoting.h"

namespace remesh::server {
namespace {

constexpr std::string_view kLocalhost = "localhost";

/// True if browsers read a name as an IPv4 address: its last part is a number (URL Standard, "ends in a number").
bool ends_in_number(std::string_view name) {
  const std::string_view last = name.substr(name.rfind('.') + 1);
  if (!last.empty() && std::all_of(last.begin(), last.end(), is_digit)) return true;
  return last.starts_with("0x") &&
         std::all_of(last.begin() + 2, last.end(), [](char c) { return is_digit(c) || (c >= 'a' && c <= 'f'); });
}

bool is_v6_in_brackets(const std::string& name) {
  in6_addr address{};
  return name.size() > 2 && name.front() == '[' && name.back() == ']' &&
         ::inet_pton(AF_INET6, name.substr(1, name.size() - 2).c_str(), &address) == 1;
}

/// True for a number of 16 bits, and for no text at all.
bool is_port(std::string_view text) {
  constexpr std::size_t kLongest = 5;
  constexpr int kLargest = 65535;
  int port = 0;
  for (const char c : text.substr(0, kLongest)) {
    if (!is_digit(c)) return false;
    port = 10 * port + (c - '0');
  }
  return text.size() <= kLongest && port <= kLargest;
}

std::string_view standard_port(std::string_view scheme) {
  return scheme == "http" ? "80" : scheme == "https" ? "443" : "";
}

}  // namespace

Host parse_host(std::string_view text) {
  const std::size_t name_end = text.starts_with('[') ? text.find(']') : 0;
  const std::size_t colon = name_end == std::string_view::npos ? name_end : text.find(':', name_end);
  Host host{api::ascii_lower(text.substr(0, colon)), ""};
  if (colon != std::string_view::npos) host.port = text.substr(colon + 1);
  if (host.name.ends_with('.')) host.name.pop_back();
  return host;
}

HostKind kind_of(const Host& host) {
  const std::string& name = host.name;
  if (!is_port(host.port)) return HostKind::kMalformed;
  if (name.find_first_of("[]") != std::string::npos)
    return is_v6_in_brackets(name) ? HostKind::kAddress : HostKind::kMalformed;
  if (name.empty()) return HostKind::kNone;
  if (ends_in_number(name)) return HostKind::kAddress;
  if (name == kLocalhost || name.ends_with("." + std::string(kLocalhost))) return HostKind::kLocalhost;
  return name.find('.') == std::string::npos ? HostKind::kDotless : HostKind::kDomain;
}

std::optional<Origin> parse_origin(std::string_view text) {
  const std::size_t end = text.find("://");
  if (end == std::string_view::npos || end == 0) return std::nullopt;
  const std::string_view host = text.substr(end + 3);
  if (host.empty() || host.find_first_of("/?#@, \"\\") != std::string_view::npos) return std::nullopt;
  return Origin{api::ascii_lower(text.substr(0, end)), parse_host(host)};
}

bool is_at(const Origin& origin, const Host& host) {
  const std::string_view standard = standard_port(origin.scheme);
  const auto port_of = [&](const Host& h) { return h.port.empty() ? standard : std::string_view(h.port); };
  return origin.host.name == host.name && port_of(origin.host) == port_of(host);
}

}  // namespace remesh::server
