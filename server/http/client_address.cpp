#include "server/http/client_address.h"

#include <arpa/inet.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <optional>
#include <stdexcept>

#include "api/multipart.h"
#include "server/http/header_lists.h"

namespace remesh::server {
namespace {

using Bits = std::array<std::uint8_t, 16>;
constexpr int kMappedLength = 96;  ///< the bits before an IPv4 address that is mapped to IPv6

std::optional<Bits> bits_of(const std::string& text, bool& is_v4) {
  Bits bits{};
  in_addr v4{};
  is_v4 = ::inet_pton(AF_INET, text.c_str(), &v4) == 1;
  if (is_v4) {
    bits[10] = bits[11] = 0xff;
    std::memcpy(bits.data() + 12, &v4, sizeof v4);
    return bits;
  }
  if (::inet_pton(AF_INET6, text.c_str(), bits.data()) == 1) return bits;
  return std::nullopt;
}

bool is_address(const std::string& text) {
  bool is_v4 = false;
  return bits_of(text, is_v4).has_value();
}

/// Removes quotes, brackets and the port: `"[2001:db8::1]:4711"` becomes `2001:db8::1`.
/// Output: empty if the text is no address, such as `unknown`.
std::string bare_address(std::string_view text) {
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
  if (text.starts_with('[')) {
    text = text.substr(1, text.find(']') - 1);
  } else if (std::count(text.begin(), text.end(), ':') == 1) {
    text = text.substr(0, text.find(':'));
  }
  std::string address(text);
  return is_address(address) ? address : std::string();
}

/// The addresses of the client and of the proxies through which a request came, in this order. Hidden addresses are
/// empty.
std::vector<std::string> named_addresses(const RequestHead& head) {
  std::vector<std::string> addresses;
  if (head.has("x-forwarded-for")) {
    const std::string list = head.list("x-forwarded-for");
    for (const std::string_view element : list_elements(list)) addresses.push_back(bare_address(element));
    return addresses;
  }
  const std::string list = head.list("forwarded");
  for (const std::string_view element : list_elements(list)) {
    // header_parameter skips the text before the first semicolon.
    const auto named = api::header_parameter(";" + std::string(element), "for");
    addresses.push_back(named ? bare_address(*named) : std::string());
  }
  return addresses;
}

}  // namespace

TrustedProxies::TrustedProxies(std::string_view addresses) {
  for (const std::string_view element : list_elements(addresses)) {
    const std::size_t slash = element.find('/');
    bool is_v4 = false;
    const std::optional<Bits> bits = bits_of(std::string(element.substr(0, slash)), is_v4);
    int length = is_v4 ? 32 : 128;
    bool is_good = bits.has_value();
    if (slash != std::string_view::npos) {
      const std::string_view digits = element.substr(slash + 1);
      const int longest = length;
      const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), length);
      is_good = is_good && error == std::errc() && end == digits.data() + digits.size() && length >= 0 &&
                length <= longest && digits.front() != '-';
    }
    if (!is_good) {
      throw std::invalid_argument("\"" + std::string(element) +
                                  "\" is neither an address nor a network such as 10.0.0.0/8");
    }
    networks_.push_back({*bits, length + (is_v4 ? kMappedLength : 0), std::string(element)});
  }
}

bool TrustedProxies::contains(std::string_view address) const {
  if (networks_.empty()) return false;
  bool is_v4 = false;
  const std::optional<Bits> bits = bits_of(std::string(address), is_v4);
  if (!bits) return false;
  return std::any_of(networks_.begin(), networks_.end(), [&](const Network& network) {
    for (int bit = 0; bit < network.length; ++bit) {
      const auto at = static_cast<std::size_t>(bit / 8);
      const int mask = 0x80 >> bit % 8;
      if (((network.bits[at] ^ (*bits)[at]) & mask) != 0) return false;
    }
    return true;
  });
}

std::string TrustedProxies::text() const {
  std::string text;
  for (const Network& network : networks_) text += (text.empty() ? "" : ",") + network.text;
  return text.empty() ? "none" : text;
}

std::string client_address(const RequestHead& head, const std::string& peer, const TrustedProxies& proxies) {
  if (!proxies.contains(peer)) return peer;
  const std::vector<std::string> addresses = named_addresses(head);
  std::string client = peer;
  for (auto address = addresses.rbegin(); address != addresses.rend() && !address->empty(); ++address) {
    client = *address;
    if (!proxies.contains(client)) break;
  }
  return client;
}

bool is_client_hidden(const RequestHead& head, const std::string& peer, const TrustedProxies& proxies) {
  if (!proxies.contains(peer)) return false;
  const std::vector<std::string> addresses = named_addresses(head);
  const auto first = std::find_if(addresses.rbegin(), addresses.rend(),
                                  [&](const std::string& address) { return !proxies.contains(address); });
  return first != addresses.rend() && first->empty();
}

}  // namespace remesh::server
