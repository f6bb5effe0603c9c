#include "server/observe/trace_context.h"

#include <algorithm>

namespace remesh::server {
namespace {

bool is_hex(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
}

bool is_id(std::string_view text) { return is_hex(text) && text.find_first_not_of('0') != std::string_view::npos; }

}  // namespace

std::optional<TraceContext> parse_traceparent(std::string_view text) {
  // The field looks like 00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01. Later versions may have more after
  // the flags.
  constexpr std::size_t kLength = 55;
  if (text.size() < kLength || text[2] != '-' || text[35] != '-' || text[52] != '-') return std::nullopt;
  const std::string_view version = text.substr(0, 2);
  if (!is_hex(version) || version == "ff" || !is_hex(text.substr(53, 2))) return std::nullopt;
  const bool is_longer = text.size() > kLength;
  if (is_longer && (version == "00" || text[kLength] != '-')) return std::nullopt;
  if (!is_id(text.substr(3, 32)) || !is_id(text.substr(36, 16))) return std::nullopt;
  return TraceContext{std::string(text.substr(3, 32)), std::string(text.substr(36, 16))};
}

}  // namespace remesh::server
