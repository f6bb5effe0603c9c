#include "api/file_name.h"

#include "api/quoting.h"
#include "core/io/format_spec.h"

namespace remesh::api {
namespace {

constexpr std::size_t kMaxCharacters = 100;
constexpr std::string_view kHexDigits = "0123456789ABCDEF";

bool is_plain(char c) { return is_letter(c) || is_digit(c) || c == '.' || c == '_' || c == '-'; }

/// True for characters that control how text is shown instead of being shown: U+0080 to U+009F, and the marks that
/// change its direction, with which a name could pretend to have another ending.
bool is_invisible(std::string_view character) {
  if (character.size() == 2) return character[0] == '\xc2' && static_cast<unsigned char>(character[1]) < 0xa0;
  return character.substr(0, 2) == "\xe2\x80" || character.substr(0, 2) == "\xe2\x81" || character == "\xef\xbb\xbf";
}

/// Returns the name without folders and endings, and with `_` for everything that is not safe in a name.
std::string safe_stem(std::string_view name) {
  name = name.substr(name.find_last_of("/\\") + 1);
  if (is_gzip_file_name(name)) name.remove_suffix(3);
  if (format_from_file_name(name)) name = name.substr(0, name.rfind('.'));
  std::string safe;
  for (std::size_t count = 0; !name.empty() && count < kMaxCharacters; ++count) {
    const std::size_t length = utf8_length(name);
    const std::string_view character = name.substr(0, length == 0 ? 1 : length);
    name.remove_prefix(character.size());
    if (character == "." && safe.empty()) continue;
    const bool is_safe = character.size() == 1 ? is_plain(character[0]) : !is_invisible(character);
    safe.append(is_safe ? character : "_");
  }
  return safe.empty() ? "remeshed" : safe;
}

/// Replaces each character beyond ASCII by `_`.
std::string in_ascii(std::string_view text) {
  std::string ascii;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80) ascii += c;
    if (byte >= 0xc0) ascii += '_';  // the first byte of a character
  }
  return ascii;
}

}  // namespace

std::string content_disposition(std::string_view upload, Format format) {
  const std::string name = safe_stem(upload).append(".").append(file_ending(format));
  const std::string ascii = in_ascii(name);
  std::string value = "attachment; filename=\"" + ascii + "\"";
  if (ascii != name) value += "; filename*=UTF-8''" + percent_encoded(name, "._-");
  return value;
}

bool is_file_name(std::string_view text) {
  constexpr std::size_t kLongest = 255;
  return text.size() <= kLongest && text.find_first_of(std::string_view("\n\r\0{", 4)) == std::string_view::npos &&
         format_from_file_name(text).has_value();
}

std::string decode_extended_value(std::string_view value) {
  const auto [charset, rest] = cut(value, '\'');
  const std::string_view text = cut(rest, '\'').second;
  if (ascii_lower(charset) != "utf-8") return {};
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      decoded += text[i];
      continue;
    }
    const auto digit = [&](std::size_t at) {
      const char c = at < text.size() ? text[at] : ' ';
      return kHexDigits.find(c >= 'a' && c <= 'f' ? static_cast<char>(c - 'a' + 'A') : c);
    };
    const std::size_t high = digit(i + 1), low = digit(i + 2);
    if (high == std::string_view::npos || low == std::string_view::npos) return {};
    decoded += static_cast<char>(high * 16 + low);
    i += 2;
  }
  return decoded;
}

}  // namespace remesh::api
