#include "server/http/request_head.h"

#include <algorithm>
#include <charconv>

#include "api/quoting.h"
#include "server/http/header_lists.h"
#include "server/http/hex.h"

namespace remesh::server {
namespace {

[[noreturn]] void malformed(const std::string& detail) { throw HttpError(400, "malformed_request", detail); }

bool is_alphanumeric(char c) { return is_digit(c) || is_letter(c); }

bool is_token_char(char c) {
  if (is_alphanumeric(c)) return true;
  return c != '\0' && std::string_view("!#$%&'*+-.^_`|~").find(c) != std::string_view::npos;
}

bool is_token(std::string_view text) { return !text.empty() && std::all_of(text.begin(), text.end(), is_token_char); }

/// Removes and returns the first line of `rest`, up to the next CRLF.
std::string_view take_line(std::string_view& rest) {
  const std::size_t end = rest.find("\r\n");
  const std::string_view line = rest.substr(0, end);
  rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 2);
  return line;
}

Fields parse_query(std::string_view text) {
  Fields query;
  while (!text.empty()) {
    const std::size_t end = text.find('&');
    const std::string_view pair = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (pair.empty()) continue;
    const std::size_t equals = pair.find('=');
    query.emplace_back(percent_decode(pair.substr(0, equals)),
                       equals == std::string_view::npos ? "" : percent_decode(pair.substr(equals + 1)));
  }
  return query;
}

/// True if every character may occur in a Host field: a name or an address, and a port (RFC 9110, section 7.2). It
/// may be empty.
bool is_host(std::string_view text) {
  constexpr std::string_view kSigns = "-._~%!$&'()*+,;=:[]";
  return std::all_of(text.begin(), text.end(),
                     [&](char c) { return is_alphanumeric(c) || kSigns.find(c) != std::string_view::npos; });
}

void parse_target(std::string_view target, RequestHead& head) {
  // The absolute form is meant for proxies, but a server must accept it (RFC 9112, section 3.2.2). Its path may be
  // empty.
  bool is_absolute = false;
  for (const std::string_view scheme : {std::string_view("http://"), std::string_view("https://")}) {
    if (api::ascii_lower(target.substr(0, scheme.size())) != scheme) continue;
    is_absolute = true;
    const std::size_t end = std::min(target.find_first_of("/?#", scheme.size()), target.size());
    head.target_authority = target.substr(scheme.size(), end - scheme.size());
    if (!is_host(head.target_authority)) malformed("the request target names no host");
    target.remove_prefix(end);
    break;
  }
  const std::size_t question = target.find('?');
  const std::string_view path = target.substr(0, question);
  const bool is_asterisk = head.method == "OPTIONS" && path == "*";
  if (!path.starts_with('/') && !is_asterisk && !(is_absolute && path.empty()))
    malformed("the request target must be a path");
  if (question != std::string_view::npos) head.query = parse_query(target.substr(question + 1));
  head.path = path.empty() ? "/" : percent_decode(path);
}

/// True for a well-formed version that is not supported here, such as the HTTP/2.0 with which HTTP/2 begins.
bool is_other_version(std::string_view version) {
  const bool is_version = version.size() == 8 && version.starts_with("HTTP/") && is_digit(version[5]) &&
                          version[6] == '.' && is_digit(version[7]);
  return is_version && version != "HTTP/1.1" && version != "HTTP/1.0";
}

void parse_request_line(std::string_view line, RequestHead& head) {
  const std::size_t first = line.find(' ');
  const std::size_t last = line.rfind(' ');
  if (first == std::string_view::npos || first == last) malformed("the request line must be: METHOD target HTTP/1.1");
  const std::string_view method = line.substr(0, first);
  const std::string_view target = line.substr(first + 1, last - first - 1);
  const std::string_view version = line.substr(last + 1);
  if (!is_token(method)) malformed("the request method is not a token");
  if (is_other_version(version)) {
    throw HttpError(505, "http_version_not_supported",
                    "this server speaks HTTP/1.1 and HTTP/1.0, but not " + std::string(version) +
                        "; a proxy in front of it can speak HTTP/2");
  }
  if (version != "HTTP/1.1" && version != "HTTP/1.0") malformed("the request line must end in HTTP/1.1");
  if (target.empty() || target.find_first_of(" \t") != std::string_view::npos)
    malformed("a blank in the request target");
  head.method = method;
  head.minor_version = version.back() - '0';
  parse_target(target, head);
}

void parse_field(std::string_view line, RequestHead& head) {
  if (line.front() == ' ' || line.front() == '\t') malformed("folded header fields are not accepted");
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos || !is_token(line.substr(0, colon)))
    malformed("a header field without a valid name");
  head.headers.emplace_back(api::ascii_lower(line.substr(0, colon)), std::string(trimmed(line.substr(colon + 1))));
}

std::size_t count(const RequestHead& head, std::string_view name) {
  return static_cast<std::size_t>(
      std::count_if(head.headers.begin(), head.headers.end(), [&](const auto& field) { return field.first == name; }));
}

}  // namespace

std::string_view RequestHead::header(std::string_view name) const {
  for (const auto& [key, value] : headers) {
    if (key == name) return value;
  }
  return {};
}

std::string RequestHead::list(std::string_view name) const {
  std::string values;
  for (const auto& [key, value] : headers) {
    if (key == name && !value.empty()) values.append(values.empty() ? "" : ", ").append(value);
  }
  return values;
}

bool RequestHead::has(std::string_view name) const {
  return std::any_of(headers.begin(), headers.end(), [&](const auto& field) { return field.first == name; });
}

std::string_view RequestHead::authority() const {
  return target_authority.empty() ? header("host") : std::string_view(target_authority);
}

std::string percent_decode(std::string_view text) {
  std::string decoded;
  decoded.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      decoded += text[i];
      continue;
    }
    const int high = i + 2 < text.size() ? hex_digit(text[i + 1]) : -1;
    const int low = i + 2 < text.size() ? hex_digit(text[i + 2]) : -1;
    if (high < 0 || low < 0) malformed("an incomplete percent escape in the request target");
    if (high == 0 && low == 0) malformed("an escaped NUL in the request target");
    decoded += static_cast<char>(high * 16 + low);
    i += 2;
  }
  return decoded;
}

std::optional<std::size_t> find_head_end(std::string_view bytes, std::size_t& checked, const HeadLimits& limits) {
  const std::size_t end = std::min(bytes.size(), limits.max_bytes);
  for (std::size_t i = checked; i < end; ++i) {
    const auto c = static_cast<unsigned char>(bytes[i]);
    if (c == '\n') {
      if (i == 0 || bytes[i - 1] != '\r') malformed("a line that ends in a bare line feed");
      if (i == 1) malformed("an empty request line");
      if (i >= 3 && bytes[i - 2] == '\n') return i + 1;
    } else if (i > 0 && bytes[i - 1] == '\r') {
      malformed("a carriage return inside a line");
    } else if ((c < 0x20 && c != '\t' && c != '\r') || c == 0x7f) {
      malformed("a control character in the request head");
    }
  }
  checked = end;
  if (bytes.size() >= limits.max_bytes) {
    if (bytes.substr(0, end).find('\n') == std::string_view::npos) {
      throw HttpError(414, "uri_too_long", "the request line is longer than a request head may be")
          .with_limit(limits.max_bytes);
    }
    throw HttpError(431, "header_fields_too_large", "the request head is too long").with_limit(limits.max_bytes);
  }
  return std::nullopt;
}

std::string_view method_of(std::string_view bytes) {
  const std::string_view method = bytes.substr(0, bytes.find(' '));
  return method.size() < bytes.size() && is_token(method) ? method : std::string_view();
}

void parse_head(std::string_view bytes, const HeadLimits& limits, RequestHead& head) {
  parse_request_line(take_line(bytes), head);
  while (!bytes.empty()) {
    const std::string_view line = take_line(bytes);
    if (line.empty()) break;
    if (head.headers.size() == limits.max_fields) {
      throw HttpError(431, "header_fields_too_large", "too many header fields").with_limit(limits.max_fields);
    }
    parse_field(line, head);
  }
  const std::size_t hosts = count(head, "host");
  if (hosts > 1 || (hosts == 0 && head.minor_version >= 1)) malformed("there must be exactly one Host field");
  if (!is_host(head.header("host"))) malformed("the Host field is not a valid host name");
  for (const std::string_view name : {"content-type", "authorization", "x-api-key", "idempotency-key"}) {
    if (count(head, name) > 1) malformed("the field " + std::string(name) + " is sent more than once");
  }
}

bool wants_to_be_kept(const RequestHead& head) {
  bool keeps = head.minor_version >= 1;
  for (const auto& [name, value] : head.headers) {
    if (name != "connection") continue;
    for (std::string_view rest = value; !rest.empty();) {
      const auto [text, others] = api::cut(rest, ',');
      const std::string option = api::ascii_lower(trimmed(text));
      if (option == "close") return false;
      keeps = keeps || option == "keep-alive";
      rest = others;
    }
  }
  return keeps;
}

Framing framing(const RequestHead& head) {
  const std::size_t lengths = count(head, "content-length");
  const std::size_t codings = count(head, "transfer-encoding");
  if (codings > 0) {
    if (lengths > 0) malformed("Content-Length beside Transfer-Encoding");
    if (head.minor_version == 0) malformed("Transfer-Encoding in HTTP/1.0");
    if (codings > 1) malformed("Transfer-Encoding more than once");
    if (api::ascii_lower(head.header("transfer-encoding")) != "chunked") {
      throw HttpError(501, "not_implemented", "the only transfer coding known here is chunked");
    }
    return {Framing::Kind::kChunked, 0};
  }
  if (lengths == 0) {
    if (head.method == "POST") {
      throw HttpError(411, "length_required", "a POST needs Content-Length or chunked transfer coding");
    }
    return {};
  }
  if (lengths > 1) malformed("Content-Length more than once");
  const std::string_view text = head.header("content-length");
  std::uint64_t length = 0;
  // For an unsigned number, from_chars accepts digits only: no sign, no blank, no 0x.
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), length);
  if (text.empty() || error != std::errc() || end != text.data() + text.size())
    malformed("Content-Length is not a number");
  return {Framing::Kind::kLength, length};
}

}  // namespace remesh::server
