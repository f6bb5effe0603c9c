/// The API keys that clients must show, read from a file and from the environment.
#pragma once

#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/http/digest.h"
#include "server/http/http_message.h"

namespace remesh::server {

/// Stores digests of the keys, never the keys. Threads may call it while the file is read again.
class ApiKeys {
 public:
  static constexpr std::size_t kShortest = 16;

  /// Input:   `file` - a file with one key per line, as `KEY` or `NAME KEY` (empty lines and lines with # are skipped),
  ///          or empty; `key` - one more key, or empty.
  /// Errors:  std::invalid_argument - the file is missing or has no key, a key has less than 16 characters or contains
  ///          a blank, or a name is not a letter followed by at most 63 letters, digits and `._-`.
  ApiKeys(std::string file, const std::string& key);

  /// Reads the file again.
  /// Errors: as above. All keys of the file are then refused until it can be read, because a key that was taken out
  ///         must not stay in force.
  void reload();

  /// True if no key is required.
  bool is_open() const { return !asks_; }
  std::size_t count() const { return current()->size(); }
  /// True if a request sends one of the keys, as `Authorization: Bearer KEY` or `X-API-Key: KEY`. The time that the
  /// test takes depends on the length of the sent key only.
  bool admits(const RequestHead& head) const;
  /// True if the owner still has a key. Streams ask for it again and again, since they may outlive a key.
  bool has_owner(std::string_view owner) const;
  /// An identifier of the key that a request sends. It does not reveal the key.
  /// Output: empty if no key is required.
  std::string owner(const RequestHead& head) const;

  /// The name of an owner's key, for people and metrics: that of its line in the file, else the line's number, or
  /// "environment" for the key from there.
  /// Output: empty if the owner has no key.
  std::string name_of(std::string_view owner) const;

  /// How long a token is valid.
  static constexpr std::chrono::minutes kTokenLife{15};
  /// Makes a token with which a request without a key may read one path on behalf of the owner of a key. Browsers
  /// cannot send a key when they follow a stream of events. All daemons that have the key know the token.
  /// Input:  `head` - a request that sends a key.
  /// Output: empty if no key is required.
  std::string token(const RequestHead& head, std::string_view path, std::chrono::system_clock::time_point now) const;
  /// Output: the owner for whom a token was made; nothing if the token is not valid for this path, or has expired.
  std::optional<std::string> owner_by_token(std::string_view token, std::string_view path,
                                            std::chrono::system_clock::time_point now) const;

 private:
  struct Key {
    Sha256 digest;
    std::string owner;
    std::string name;
  };
  using Keys = std::vector<Key>;

  static Key make_key(const std::string& key, std::string name);
  static Keys read_file(const std::string& path);
  std::shared_ptr<const Keys> current() const;
  void set(Keys keys);

  const std::string file_;
  Keys fixed_;  ///< the key that comes from the environment
  bool asks_;
  mutable std::mutex mutex_;
  std::shared_ptr<const Keys> keys_;
};

}  // namespace remesh::server
