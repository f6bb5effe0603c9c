#include "core/io/common/text_lines.h"

#include <array>
#include <string>

#include "core/io/common/number_parsing.h"
#include "core/io/common/read_errors.h"

namespace remesh {
namespace {

enum class ByteKind : unsigned char { kText, kLineEnd, kControl };

constexpr std::array<ByteKind, 256> kByteKind = [] {
  std::array<ByteKind, 256> kinds{};
  for (int byte = 0; byte < 256; ++byte) {
    const char c = static_cast<char>(byte);
    if (is_control_character(c)) kinds[byte] = ByteKind::kControl;
    if (c == '\n' || c == '\r') kinds[byte] = ByteKind::kLineEnd;
  }
  return kinds;
}();

std::string hexadecimal(unsigned char byte) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  return {'0', 'x', kDigits[byte >> 4], kDigits[byte & 15]};
}

}  // namespace

std::optional<std::string_view> wide_encoding(std::string_view text) {
  // UTF-32 is checked before UTF-16, because its mark may begin like one of UTF-16.
  if (text.starts_with(std::string_view("\xff\xfe\0\0", 4))) return "UTF-32 (little endian)";
  if (text.starts_with(std::string_view("\0\0\xfe\xff", 4))) return "UTF-32 (big endian)";
  if (text.starts_with("\xff\xfe")) return "UTF-16 (little endian)";
  if (text.starts_with("\xfe\xff")) return "UTF-16 (big endian)";
  return std::nullopt;
}

TextLines::TextLines(std::string_view text) : text_(text) {
  if (const auto encoding = wide_encoding(text)) {
    throw read_error(Place::line(1), Code::kInvalidMesh,
                     "the text is in " + std::string(*encoding) +
                         "; meshes are read in UTF-8 or any other encoding that extends ASCII");
  }
  text_ = without_padding(text);
  if (text.starts_with(kUtf8Mark)) offset_ = kUtf8Mark.size();
}

bool TextLines::next() {
  if (offset_ >= text_.size()) return false;
  ++number_;
  control_character_.reset();
  const char* const begin = text_.data() + offset_;
  const char* const end = text_.data() + text_.size();
  const char* at = begin;
  for (;; ++at) {
    while (at != end && kByteKind[static_cast<unsigned char>(*at)] == ByteKind::kText) ++at;
    if (at == end || kByteKind[static_cast<unsigned char>(*at)] == ByteKind::kLineEnd) break;
    if (!control_character_) control_character_ = static_cast<unsigned char>(*at);
  }
  line_ = {begin, static_cast<std::size_t>(at - begin)};
  if (at != end) at += *at == '\r' && at + 1 != end && at[1] == '\n' ? 2 : 1;
  offset_ = static_cast<std::size_t>(at - text_.data());
  return true;
}

void TextLines::check_is_text() const {
  if (!control_character_) return;
  throw read_error(Place::line(number_), Code::kInvalidMesh,
                   "not a text file: it holds the control character " + hexadecimal(*control_character_));
}

}  // namespace remesh
