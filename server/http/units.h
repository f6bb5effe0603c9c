/// Parses and formats sizes, counts and times as people write them in a configuration.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

namespace remesh::server {

/// Parses a size: "4096", "32KiB", "256MiB", "1GiB", "20MB".
/// Errors: std::invalid_argument.
std::uint64_t parse_bytes(std::string_view text);
/// Parses a count: "500", "20k", "10M", "2G". The suffixes are powers of ten.
/// Errors: std::invalid_argument.
std::uint64_t parse_count(std::string_view text);
/// Parses a time: "250ms", "30s", "5min", "1h"; a bare number means seconds.
/// Errors: std::invalid_argument.
std::chrono::milliseconds parse_duration(std::string_view text);

/// The following functions choose the shortest of the forms above that is exact.
std::string format_bytes(std::uint64_t bytes);
std::string format_count(std::uint64_t count);
std::string format_duration(std::chrono::milliseconds duration);

/// An address to listen on: "127.0.0.1:8080", "[::1]:8080", "localhost:0" (port 0 means any free port).
struct Address {
  std::string host;
  int port = 0;

  bool is_loopback() const;
  std::string text() const;
};
/// Errors: std::invalid_argument.
Address parse_address(std::string_view text);

}  // namespace remesh::server
