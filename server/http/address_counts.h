/// How many connections each client address holds, so that one address cannot take them all.
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

  /// One connection's place; given back at its end.
  class Place {
   public:
    Place(AddressCounts& counts, std::string key) : counts_(&counts), key_(std::move(key)) {}
    Place(Place&& other) noexcept : counts_(std::exchange(other.counts_, nullptr)), key_(std::move(other.key_)) {}
    Place& operator=(Place&&) = delete;
    ~Place() {
      if (counts_ != nullptr) counts_->leave(key_);
    }

   private:
    AddressCounts* counts_;
    std::string key_;
  };

  /// Takes a place for a numeric address. Output: nothing when it holds as many as it may.
  std::optional<Place> enter(const std::string& address);

 private:
  void leave(const std::string& key);

  const std::size_t most_;
  std::mutex mutex_;
  std::map<std::string, std::size_t> open_;
};

/// What counts as one client: an IPv4 address, also written as IPv6, or the /64 network of an IPv6 address, which one
/// subscriber holds whole.
std::string client_key(const std::string& address);

}  // namespace remesh::server
