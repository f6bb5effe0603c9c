#include "server/http/api_keys.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <fstream>
#include <stdexcept>
#include <utility>

#include "api/quoting.h"
#include "server/http/header_lists.h"

namespace remesh::server {
namespace {

void check_key(const std::string& key, const std::string& place) {
  const bool is_visible = std::all_of(key.begin(), key.end(), [](char c) { return c > ' ' && c < 0x7f; });
  if (!is_visible) throw std::invalid_argument(place + " has a key with a blank or a character that is not ASCII");
  if (key.size() < ApiKeys::kShortest) {
    throw std::invalid_argument(place + " has a key of less than " + std::to_string(ApiKeys::kShortest) +
                                " characters");
  }
}

std::vector<Sha256> read_keys(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::invalid_argument("the key file " + path + " cannot be read");
  std::vector<Sha256> digests;
  for (std::string line; std::getline(file, line);) {
    const std::string key(trimmed(line));
    if (key.empty() || key.front() == '#') continue;
    check_key(key, "the key file " + path);
    digests.push_back(sha256(key));
  }
  if (digests.empty()) throw std::invalid_argument("the key file " + path + " has no key");
  return digests;
}

/// The key that a request sends.
/// Output: empty if it sends none.
std::string_view shown_key(const RequestHead& head) {
  constexpr std::string_view kScheme = "bearer ";
  const std::string_view authorization = head.header("authorization");
  if (api::ascii_lower(authorization.substr(0, kScheme.size())) == kScheme)
    return trimmed(authorization.substr(kScheme.size()));
  return head.header("x-api-key");
}

/// The owner that a key stands for.
/// Input: `digest` - of the key. The digest is hashed again, so that no database stores the digests that are used for
///        comparison.
std::string owner_of(const Sha256& digest) {
  return hex(sha256({reinterpret_cast<const char*>(digest.data()), digest.size()})).substr(0, 32);
}

std::int64_t seconds_of(std::chrono::system_clock::time_point time) {
  return std::chrono::floor<std::chrono::seconds>(time.time_since_epoch()).count();
}

Sha256 token_code(const Sha256& key, std::string_view path, std::string_view end) {
  return hmac_sha256(key, std::string(path) + "\n" + std::string(end));
}

}  // namespace

ApiKeys::ApiKeys(std::string file, const std::string& key)
    : file_(std::move(file)), asks_(!file_.empty() || !key.empty()), digests_(std::make_shared<Digests>()) {
  if (!key.empty()) {
    check_key(key, "REMESHD_API_KEY");
    fixed_.push_back(sha256(key));
  }
  reload();
}

void ApiKeys::reload() {
  Digests digests = fixed_;
  try {
    if (!file_.empty())
      for (const Sha256& digest : read_keys(file_)) digests.push_back(digest);
  } catch (...) {
    set(fixed_);  // a key that was taken out must not stay in force because something else is wrong
    throw;
  }
  set(std::move(digests));
}

void ApiKeys::set(Digests digests) {
  auto shared = std::make_shared<const Digests>(std::move(digests));
  const std::lock_guard lock(mutex_);
  digests_ = std::move(shared);
}

bool ApiKeys::has_owner(std::string_view owner) const {
  if (is_open()) return true;
  const std::shared_ptr<const Digests> digests = current();
  return std::any_of(digests->begin(), digests->end(), [&](const Sha256& digest) { return owner_of(digest) == owner; });
}

std::shared_ptr<const ApiKeys::Digests> ApiKeys::current() const {
  const std::lock_guard lock(mutex_);
  return digests_;
}

std::string ApiKeys::owner(const RequestHead& head) const {
  return is_open() ? std::string() : owner_of(sha256(shown_key(head)));
}

std::string ApiKeys::token(const RequestHead& head, std::string_view path,
                           std::chrono::system_clock::time_point now) const {
  if (is_open()) return {};
  const std::string end = std::to_string(seconds_of(now + kTokenLife));
  return end + "." + hex(token_code(sha256(shown_key(head)), path, end));
}

std::optional<std::string> ApiKeys::owner_by_token(std::string_view token, std::string_view path,
                                                   std::chrono::system_clock::time_point now) const {
  const auto [end, code] = api::cut(token, '.');
  std::int64_t seconds = 0;
  const auto [rest, error] = std::from_chars(end.data(), end.data() + end.size(), seconds);
  if (error != std::errc() || rest != end.data() + end.size() || seconds < seconds_of(now)) return std::nullopt;
  const Sha256 shown = sha256(code);
  const std::shared_ptr<const Digests> digests = current();
  std::optional<std::string> owner;
  for (const Sha256& digest : *digests) {
    if (equal_in_constant_time(sha256(hex(token_code(digest, path, end))), shown)) owner = owner_of(digest);
  }
  return owner;
}

bool ApiKeys::admits(const RequestHead& head) const {
  if (is_open()) return true;
  const Sha256 shown = sha256(shown_key(head));
  const std::shared_ptr<const Digests> digests = current();
  bool is_known = false;
  for (const Sha256& digest : *digests) is_known = equal_in_constant_time(digest, shown) || is_known;
  return is_known;
}

}  // namespace remesh::server
