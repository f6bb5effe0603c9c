/// The keys that clients show, from a file and from the environment.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "server/http/digest.h"
#include "server/http/http_message.h"

namespace remesh::server {

/// Holds digests, never the keys. May be asked by many threads while it is read again.
class ApiKeys {
 public:
  static constexpr std::size_t kShortest = 16;

  /// Input:   a file with a key a line (empty lines and those with # are skipped), or none; one key more, or none.
  /// Errors:  std::invalid_argument - no file there, no key in it, or a key of less than 16 characters or with a blank.
  ApiKeys(std::string file, const std::string& key);

  /// Reads the file again. Errors: as above; the keys then stay as they were.
  void reload();

  /// True where anyone may ask.
  bool is_open() const { return !asks_; }
  std::size_t count() const { return current()->size(); }
  /// Whether a request shows one of them, as `Authorization: Bearer KEY` or `X-API-Key: KEY`.
  /// Takes as long whatever is shown, but for the key's length.
  bool admits(const RequestHead& head) const;
  /// A name for whoever holds the key that a request shows, which does not tell the key; empty where anyone may ask.
  std::string owner(const RequestHead& head) const;

 private:
  using Digests = std::vector<Sha256>;

  std::shared_ptr<const Digests> current() const;

  const std::string file_;
  Digests fixed_;  ///< of the key that is no file's
  bool asks_;
  mutable std::mutex mutex_;
  std::shared_ptr<const Digests> digests_;
};

}  // namespace remesh::server
