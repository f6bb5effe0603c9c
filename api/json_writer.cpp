#include "api/json_writer.h"

#include <cmath>

#include "core/io/common/number_parsing.h"

namespace remesh::api {

void JsonWriter::separate() {
  if (out_.size() >= piece_) {
    in_pieces_ += out_.size();
    pieces_.push_back(std::move(out_));
    out_.clear();
    out_.reserve(piece_ + piece_ / 16);
  }
  if (needs_comma_) out_ += ',';
  needs_comma_ = true;
}

void JsonWriter::open(char bracket) {
  separate();
  out_ += bracket;
  needs_comma_ = false;
}

void JsonWriter::close(char bracket) {
  out_ += bracket;
  needs_comma_ = true;
}

void JsonWriter::literal(std::string_view text) {
  separate();
  out_ += text;
}

void JsonWriter::key(std::string_view name) {
  separate();
  quote(name);
  out_ += ':';
  needs_comma_ = false;
}

void JsonWriter::number(double value) {
  if (!std::isfinite(value)) return null();
  // Most readers treat "-0" as an integer and lose its sign.
  if (value == 0 && std::signbit(value)) return literal("-0.0");
  separate();
  append_real(out_, value);
}

void JsonWriter::integer(std::uint64_t value) {
  separate();
  append_integer(out_, value);
}

void JsonWriter::signed_integer(std::int64_t value) {
  separate();
  const auto bits = static_cast<std::uint64_t>(value);
  if (value < 0) out_ += '-';
  append_integer(out_, value < 0 ? 0 - bits : bits);
}

void JsonWriter::string(std::string_view value) {
  separate();
  quote(value);
}

void JsonWriter::quote(std::string_view text) {
  constexpr std::string_view kHex = "0123456789abcdef";
  constexpr std::string_view kReplacement = "\xEF\xBF\xBD";  // U+FFFD
  out_ += '"';
  while (!text.empty()) {
    const char c = text.front();
    const std::size_t length = utf8_length(text);
    if (length == 0) {
      out_ += kReplacement;
    } else if (c == '"' || c == '\\') {
      out_ += '\\';
      out_ += c;
    } else if (c == '\n') {
      out_ += "\\n";
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) {
      out_ += "\\u00";
      out_ += kHex[static_cast<unsigned char>(c) >> 4];
      out_ += kHex[static_cast<unsigned char>(c) & 15];
    } else {
      out_ += text.substr(0, length);
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  out_ += '"';
}

}  // namespace remesh::api
