/// SHA-256 and Base64, computed by OpenSSL.
#pragma once

#include <array>
#include <string>
#include <string_view>

namespace remesh::server {

using Sha256 = std::array<unsigned char, 32>;

/// Computes the SHA-256 digest.
/// Errors: std::bad_alloc.
Sha256 sha256(std::string_view bytes);

/// Computes the HMAC-SHA-256 of a text (RFC 2104), which can be made only with the key.
/// Errors: std::bad_alloc.
Sha256 hmac_sha256(const Sha256& key, std::string_view text);

/// Formats a digest as hexadecimal digits.
std::string hex(const Sha256& digest);

/// Compares two digests in a time that does not reveal where they differ.
bool equal_in_constant_time(const Sha256& a, const Sha256& b);

/// Returns the value of a `Repr-Digest` field (RFC 9530): `sha-256=:...:`.
std::string repr_digest(std::string_view bytes);

}  // namespace remesh::server
