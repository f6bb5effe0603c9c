#include "core/io/obj_records.h"

#include <algorithm>
#include <array>

#include "core/base/error.h"
#include "core/io/text.h"

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

// Not <cctype>: the records do not depend on a locale.
constexpr bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
constexpr bool is_keyword_character(char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_'; }

bool is_keyword(std::string_view token) {
  return is_letter(token.front()) && std::all_of(token.begin(), token.end(), is_keyword_character);
}

bool is_comment(std::string_view line) {
  const std::string_view first = next_token(line);
  return first.starts_with('#');
}

Error invalid(std::uint64_t line, const std::string& message) {
  return Error(Code::kInvalidMesh, Stage::kRead, message).at_line(line);
}

std::string hexadecimal(unsigned char byte) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  return {'0', 'x', kDigits[byte >> 4], kDigits[byte & 15]};
}

}  // namespace

ObjRecords::ObjRecords(std::string_view text) : text_(text) {
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")) {
    throw invalid(1, "the text is in UTF-16; OBJ is read in UTF-8 or any other encoding that extends ASCII");
  }
  if (text.starts_with("\xef\xbb\xbf")) offset_ = 3;
}

bool ObjRecords::next() {
  while (offset_ < text_.size()) {
    std::string_view rest = take_logical_line();
    const std::string_view first = next_token(rest);
    if (first.starts_with('#')) continue;
    if (control_character_) {
      throw invalid(line_, "not a text file: it holds the control character " + hexadecimal(*control_character_));
    }
    if (first.empty()) continue;
    if (!is_keyword(first)) throw invalid(line_, "not an OBJ record: the line does not start with a keyword");
    keyword_ = first;
    arguments_ = rest;
    return true;
  }
  return false;
}

/// Up to the line end, which is taken too.
std::string_view ObjRecords::take_physical_line() {
  ++lines_taken_;
  const char* const begin = text_.data() + offset_;
  const char* const end = text_.data() + text_.size();
  const char* at = begin;
  for (;; ++at) {
    while (at != end && kByteKind[static_cast<unsigned char>(*at)] == ByteKind::kText) ++at;
    if (at == end || kByteKind[static_cast<unsigned char>(*at)] == ByteKind::kLineEnd) break;
    if (!control_character_) control_character_ = static_cast<unsigned char>(*at);
  }
  const std::string_view line(begin, static_cast<std::size_t>(at - begin));
  if (at != end) at += *at == '\r' && at + 1 != end && at[1] == '\n' ? 2 : 1;
  offset_ = static_cast<std::size_t>(at - text_.data());
  return line;
}

std::string_view ObjRecords::take_logical_line() {
  line_ = lines_taken_ + 1;
  control_character_.reset();
  std::string_view line = take_physical_line();
  if (!line.ends_with('\\') || is_comment(line)) return line;

  joined_.clear();
  while (line.ends_with('\\')) {
    joined_.append(line.substr(0, line.size() - 1));
    joined_ += ' ';  // nobody breaks a line inside a number, some break it right after one
    if (offset_ == text_.size()) return joined_;
    line = take_physical_line();
  }
  joined_.append(line);
  return joined_;
}

}  // namespace remesh
