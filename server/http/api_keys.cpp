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

void check_name(std::string_view name, const std::string& place) {
  constexpr std::size_t kLongest = 64;
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const bool is_plain = std::all_of(name.begin(), name.end(), [&](char c) {
    return is_letter(c) || (c >= '0' && c <= '9') || c == '.' || c == '_' || c == '-';
  });
  // A name that begins with a digit could be taken for the number of a line.
  if (is_plain && is_letter(name.front()) && name.size() <= kLongest) return;
  throw std::invalid_argument(place +
                              ": the name of a key is a letter, followed by at most 63 letters, digits, dots, "
                              "underscores and hyphens");
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
    : file_(std::move(file)), asks_(!file_.empty() || !key.empty()), keys_(std::make_shared<Keys>()) {
  if (!key.empty()) {
    check_key(key, "REMESHD_API_KEY");
    fixed_.push_back(make_key(key, "environment"));
  }
  reload();
}

ApiKeys::Key ApiKeys::make_key(const std::string& key, std::string name) {
  const Sha256 digest = sha256(key);
  return {digest, owner_of(digest), std::move(name)};
}

ApiKeys::Keys ApiKeys::read_file(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::invalid_argument("the key file " + path + " cannot be read");
  Keys keys;
  std::size_t number = 0;
  for (std::string line; std::getline(file, line);) {
    ++number;
    const std::string_view text = trimmed(line);
    if (text.empty() || text.front() == '#') continue;
    const std::string place = "line " + std::to_string(number) + " of the key file " + path;
    const std::size_t blank = text.find_first_of(" \t");
    const bool has_name = blank != std::string_view::npos;
    const std::string key(has_name ? trimmed(text.substr(blank)) : text);
    if (has_name) check_name(text.substr(0, blank), place);
    check_key(key, place);
    keys.push_back(make_key(key, has_name ? std::string(text.substr(0, blank)) : std::to_string(number)));
  }
  if (keys.empty()) throw std::invalid_argument("the key file " + path + " has no key");
  return keys;
}

void ApiKeys::reload() {
  Keys keys = fixed_;
  try {
    if (!file_.empty())
      for (Key& key : read_file(file_)) keys.push_back(std::move(key));
  } catch (...) {
    set(fixed_);  // a key that was taken out must not stay in force because something else is wrong
    throw;
  }
  set(std::move(keys));
}

void ApiKeys::set(Keys keys) {
  auto shared = std::make_shared<const Keys>(std::move(keys));
  const std::lock_guard lock(mutex_);
  keys_ = std::move(shared);
}

bool ApiKeys::has_owner(std::string_view owner) const { return is_open() || !name_of(owner).empty(); }

std::string ApiKeys::name_of(std::string_view owner) const {
  const std::shared_ptr<const Keys> keys = current();
  const auto found = std::find_if(keys->begin(), keys->end(), [&](const Key& key) { return key.owner == owner; });
  return found == keys->end() ? std::string() : found->name;
}

std::shared_ptr<const ApiKeys::Keys> ApiKeys::current() const {
  const std::lock_guard lock(mutex_);
  return keys_;
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
  const std::shared_ptr<const Keys> keys = current();
  std::optional<std::string> owner;
  for (const Key& key : *keys) {
    if (equal_in_constant_time(sha256(hex(token_code(key.digest, path, end))), shown)) owner = key.owner;
  }
  return owner;
}

bool ApiKeys::admits(const RequestHead& head) const {
  if (is_open()) return true;
  const Sha256 shown = sha256(shown_key(head));
  const std::shared_ptr<const Keys> keys = current();
  bool is_known = false;
  for (const Key& key : *keys) is_known = equal_in_constant_time(key.digest, shown) || is_known;
  return is_known;
}

}  // namespace remesh::server
