#include "server/http/api_keys.h"

#include <algorithm>
#include <fstream>
#include <stdexcept>
#include <utility>

#include "api/text.h"
#include "server/http/text.h"

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

/// The key that a request shows.
/// Output: empty if it shows none.
std::string_view shown_key(const RequestHead& head) {
  constexpr std::string_view kScheme = "bearer ";
  const std::string_view authorization = head.header("authorization");
  if (api::ascii_lower(authorization.substr(0, kScheme.size())) == kScheme)
    return trimmed(authorization.substr(kScheme.size()));
  return head.header("x-api-key");
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
  auto digests = std::make_shared<Digests>(fixed_);
  if (!file_.empty()) {
    const Digests read = read_keys(file_);
    digests->insert(digests->end(), read.begin(), read.end());
  }
  const std::lock_guard lock(mutex_);
  digests_ = std::move(digests);
}

std::shared_ptr<const ApiKeys::Digests> ApiKeys::current() const {
  const std::lock_guard lock(mutex_);
  return digests_;
}

std::string ApiKeys::owner(const RequestHead& head) const {
  if (is_open()) return {};
  // The key is hashed twice, so that the digests used for comparison are not stored in a database.
  const Sha256 once = sha256(shown_key(head));
  return hex(sha256({reinterpret_cast<const char*>(once.data()), once.size()})).substr(0, 32);
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
