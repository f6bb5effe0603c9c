/// Counts the connections of each client address, so that one address cannot take all connections.
#pragma once

#include <cstddef>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

namespace remesh::server {

class AddressCounts {
 public:
  explicit AddressCounts(std::size_t most) : most_(most) {}

  /// A counted connection. It is no longer counted when this object ends.
  class Place {
   public:
    Place(AddressCounts& counts, std::string key) : counts_(&counts), key_(std::move(key)) {}
    Place(Place&& other) noexcept : counts_(std::exchange(other.counts_, nullptr)), key_(std::move(other.key_)) {}
    Place& operator=(Place&& other) noexcept {
      std::swap(counts_, other.counts_);
      std::swap(key_, other.key_);
      return *this;
    }
    ~Place() {
      if (counts_ != nullptr) counts_->leave(key_);
    }

   private:
    AddressCounts* counts_;
    std::string key_;
  };

  /// Counts one more connection of a numeric address.
  /// Output: nothing if the address has the max number of connections already.
  std::optional<Place> enter(const std::string& address);

 private:
  void leave(const std::string& key);

  const std::size_t most_;
  std::mutex mutex_;
  std::map<std::string, std::size_t> open_;
};

/// The key under which an address is counted. It is the IPv4 address, also if that is written as IPv6, or the /64
/// network of an IPv6 address, because one subscriber owns a whole /64 network.
std::string client_key(const std::string& address);

}  // namespace remesh::server
