#include "server/http/address_counts.h"

#include <arpa/inet.h>

#include <array>
#include <cstring>

namespace remesh::server {

std::optional<AddressCounts::Place> AddressCounts::enter(const std::string& address) {
  std::string key = client_key(address);
  const std::lock_guard lock(mutex_);
  std::size_t& open = open_[key];
  if (open == most_) return std::nullopt;
  ++open;
  return Place(*this, std::move(key));
}

void AddressCounts::leave(const std::string& key) {
  const std::lock_guard lock(mutex_);
  const auto entry = open_.find(key);
  if (--entry->second == 0) open_.erase(entry);
}

std::string client_key(const std::string& address) {
  in6_addr v6{};
  if (::inet_pton(AF_INET6, address.c_str(), &v6) != 1) return address;
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (IN6_IS_ADDR_V4MAPPED(&v6)) return ::inet_ntop(AF_INET, v6.s6_addr + 12, text.data(), text.size());
  std::memset(v6.s6_addr + 8, 0, 8);
  return ::inet_ntop(AF_INET6, &v6, text.data(), text.size());
}

}  // namespace remesh::server
