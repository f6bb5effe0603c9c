#include "server/http/units.h"

#include <arpa/inet.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <span>
#include <stdexcept>

namespace remesh::server {
namespace {

struct Unit {
  std::string_view suffix;
  std::uint64_t factor;
};

// Factors increase within a kind, so that formatting finds the largest unit that divides the value.
constexpr std::array<Unit, 10> kByteUnits{{{"", 1},
                                           {"B", 1},
                                           {"kB", 1000},
                                           {"KB", 1000},
                                           {"MB", 1000'000},
                                           {"GB", 1000'000'000},
                                           {"KiB", 1ull << 10},
                                           {"MiB", 1ull << 20},
                                           {"GiB", 1ull << 30},
                                           {"TiB", 1ull << 40}}};
constexpr std::size_t kFirstBinary = 6;
constexpr std::array<Unit, 4> kCountUnits{{{"", 1}, {"k", 1000}, {"M", 1000'000}, {"G", 1000'000'000}}};
constexpr std::array<Unit, 5> kTimeUnits{{{"ms", 1}, {"", 1000}, {"s", 1000}, {"min", 60'000}, {"h", 3'600'000}}};

[[noreturn]] void not_a(std::string_view what, std::string_view text) {
  throw std::invalid_argument("\"" + std::string(text) + "\" is not " + std::string(what));
}

std::uint64_t parse(std::string_view text, std::span<const Unit> units, std::string_view what) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end == text.data()) not_a(what, text);
  const std::string_view suffix = text.substr(static_cast<std::size_t>(end - text.data()));
  const auto unit = std::find_if(units.begin(), units.end(), [&](const Unit& u) { return u.suffix == suffix; });
  // The end of the range is excluded, so that sums of settings and points in time cannot overflow.
  if (unit == units.end() || number > (std::numeric_limits<std::uint64_t>::max() >> 20) / unit->factor)
    not_a(what, text);
  return number * unit->factor;
}

std::string format(std::uint64_t value, std::span<const Unit> units) {
  const Unit* best = &units.front();
  for (const Unit& unit : units) {
    if (value != 0 && value % unit.factor == 0) best = &unit;
  }
  return std::to_string(value / best->factor) + std::string(best->suffix);
}

}  // namespace

std::uint64_t parse_bytes(std::string_view text) { return parse(text, kByteUnits, "a size such as 256MiB"); }
std::uint64_t parse_count(std::string_view text) { return parse(text, kCountUnits, "a count such as 20M"); }
std::chrono::milliseconds parse_duration(std::string_view text) {
  return std::chrono::milliseconds(parse(text, kTimeUnits, "a time such as 30s"));
}

std::string format_bytes(std::uint64_t bytes) {
  // Only binary units are used, because 256MiB happens to be a whole number of kB, too.
  if (bytes == 0 || bytes % 1024 != 0) return std::to_string(bytes);
  return format(bytes, std::span(kByteUnits).subspan(kFirstBinary));
}
std::string format_count(std::uint64_t count) { return format(count, kCountUnits); }
std::string format_duration(std::chrono::milliseconds duration) {
  const auto value = static_cast<std::uint64_t>(duration.count());
  // Seconds stay seconds, because the documentation says 300s and not 5min.
  return value % 1000 == 0 ? std::to_string(value / 1000) + "s" : std::to_string(value) + "ms";
}

bool Address::is_loopback() const {
  in_addr v4{};
  // The number is checked and not the text: "127.example.org" is a name that may resolve to anything.
  if (::inet_pton(AF_INET, host.c_str(), &v4) == 1) return ntohl(v4.s_addr) >> 24 == 127;
  return host == "localhost" || host == "::1";
}

std::string Address::text() const {
  const bool is_v6 = host.find(':') != std::string::npos;
  return (is_v6 ? "[" + host + "]" : host) + ":" + std::to_string(port);
}

Address parse_address(std::string_view text) {
  constexpr std::string_view kWhat = "an address such as 127.0.0.1:8080 or [::1]:8080";
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos || colon == 0) not_a(kWhat, text);
  std::string_view host = text.substr(0, colon);
  if (host.front() == '[' && host.back() == ']') {
    host = host.substr(1, host.size() - 2);
  } else if (host.find(':') != std::string_view::npos) {
    not_a(kWhat, text);
  }
  const std::string_view digits = text.substr(colon + 1);
  unsigned port = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
  if (host.empty() || error != std::errc() || end != digits.data() + digits.size() || port > 65535) not_a(kWhat, text);
  return {std::string(host), static_cast<int>(port)};
}

}  // namespace remesh::server
