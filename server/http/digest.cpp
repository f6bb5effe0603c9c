#include "server/http/digest.h"

#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>

#include <new>

namespace remesh::server {

Sha256 sha256(std::string_view bytes) {
  Sha256 digest;
  unsigned size = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), &size, EVP_sha256(), nullptr) != 1) throw std::bad_alloc();
  return digest;
}

Sha256 hmac_sha256(const Sha256& key, std::string_view text) {
  Sha256 code;
  unsigned size = 0;
  const auto* bytes = reinterpret_cast<const unsigned char*>(text.data());
  if (HMAC(EVP_sha256(), key.data(), static_cast<int>(key.size()), bytes, text.size(), code.data(), &size) == nullptr)
    throw std::bad_alloc();
  return code;
}

std::string hex(const Sha256& digest) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const unsigned char byte : digest) text.append({kDigits[byte / 16], kDigits[byte % 16]});
  return text;
}

bool equal_in_constant_time(const Sha256& a, const Sha256& b) {
  return CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

std::string repr_digest(std::string_view bytes) {
  const Sha256 digest = sha256(bytes);
  std::array<unsigned char, 4 * ((32 + 2) / 3) + 1> base64{};
  const int size = EVP_EncodeBlock(base64.data(), digest.data(), static_cast<int>(digest.size()));
  return "sha-256=:" + std::string(reinterpret_cast<const char*>(base64.data()), static_cast<std::size_t>(size)) + ":";
}

}  // namespace remesh::server
