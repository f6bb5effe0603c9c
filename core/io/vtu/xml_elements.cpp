#include "core/io/vtu/xml_elements.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <utility>

#include "core/io/common/number_parsing.h"
#include "core/io/common/read_errors.h"

namespace remesh {
namespace {

bool is_xml_space(char c) { return is_blank(c) || is_line_end(c); }

std::string_view without_prefix(std::string_view name) {
  const std::size_t colon = name.find(':');
  return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

Error unended(std::size_t begin, const char* what) {
  return read_error(Place::byte(begin), Code::kInvalidMesh, std::string("XML with ") + what + " that does not end");
}

/// Appends a character in UTF-8. The number 0 stands for none.
void append_character(std::string& out, std::uint32_t c) {
  if (c == 0) return;
  if (c < 0x80) {
    out += static_cast<char>(c);
  } else if (c < 0x800) {
    out += {static_cast<char>(0xc0 | c >> 6), static_cast<char>(0x80 | (c & 63))};
  } else if (c < 0x10000) {
    out += {static_cast<char>(0xe0 | c >> 12), static_cast<char>(0x80 | (c >> 6 & 63)),
            static_cast<char>(0x80 | (c & 63))};
  } else if (c < 0x110000) {
    out += {static_cast<char>(0xf0 | c >> 18), static_cast<char>(0x80 | (c >> 12 & 63)),
            static_cast<char>(0x80 | (c >> 6 & 63)), static_cast<char>(0x80 | (c & 63))};
  }
}

}  // namespace

std::optional<std::string_view> XmlTag::attribute(std::string_view attribute_name) const {
  std::string_view rest = attributes;
  while (true) {
    rest.remove_prefix(
        static_cast<std::size_t>(std::find_if_not(rest.begin(), rest.end(), is_xml_space) - rest.begin()));
    const std::size_t equals = rest.find('=');
    if (equals == std::string_view::npos) return std::nullopt;
    std::string_view found = rest.substr(0, equals);
    while (!found.empty() && is_xml_space(found.back())) found.remove_suffix(1);
    const std::size_t quote = rest.find_first_of("\"'", equals);
    if (quote == std::string_view::npos) return std::nullopt;
    const std::size_t end = rest.find(rest[quote], quote + 1);
    if (end == std::string_view::npos) return std::nullopt;
    if (found == attribute_name) return rest.substr(quote + 1, end - quote - 1);
    rest.remove_prefix(end + 1);
  }
}

std::optional<std::uint64_t> XmlTag::number(std::string_view attribute_name) const {
  const auto value = attribute(attribute_name);
  if (!value) return std::nullopt;
  const std::string_view digits = trim(*value);
  std::uint64_t result = 0;
  const auto [stop, status] = std::from_chars(digits.data(), digits.data() + digits.size(), result);
  if (status != std::errc() || stop != digits.data() + digits.size())
    throw read_error(Place::byte(begin), Code::kInvalidMesh,
                     "the attribute " + std::string(attribute_name) + " is no number: " + cited(digits));
  return result;
}

std::size_t XmlTags::find_end(std::size_t from) const {
  char quote = 0;
  for (std::size_t at = from; at < text_.size(); ++at) {
    const char c = text_[at];
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '>') {
      return at;
    }
  }
  throw unended(from, "a tag");
}

const XmlTag& XmlTags::next() {
  const std::size_t text_begin = tag_.end;
  std::size_t at = tag_.end;
  for (;;) {
    at = text_.find('<', at);
    if (at == std::string_view::npos) {
      text_before_ = text_.substr(text_begin);
      tag_ = {XmlTag::Kind::kEnd, {}, {}, text_.size(), text_.size()};
      return tag_;
    }
    const std::string_view rest = text_.substr(at);
    const auto skip = [&](std::string_view end, const char* what) {
      const std::size_t found = text_.find(end, at + 2);
      if (found == std::string_view::npos) throw unended(at, what);
      at = found + end.size();
    };
    if (rest.starts_with("<!--")) {
      skip("-->", "a comment");
    } else if (rest.starts_with("<?")) {
      skip("?>", "an instruction");
    } else if (rest.starts_with("<!")) {
      at = find_end(at + 1) + 1;
    } else {
      break;
    }
  }
  text_before_ = text_.substr(text_begin, at - text_begin);
  const std::size_t end = find_end(at + 1);
  std::string_view inside = text_.substr(at + 1, end - at - 1);
  tag_.kind = XmlTag::Kind::kOpen;
  if (inside.starts_with('/')) {
    tag_.kind = XmlTag::Kind::kClose;
    inside.remove_prefix(1);
  } else if (inside.ends_with('/')) {
    tag_.kind = XmlTag::Kind::kEmpty;
    inside.remove_suffix(1);
  }
  const auto name_end = std::find_if(inside.begin(), inside.end(), is_xml_space);
  const auto length = static_cast<std::size_t>(name_end - inside.begin());
  tag_.name = without_prefix(inside.substr(0, length));
  tag_.attributes = inside.substr(length);
  tag_.begin = at;
  tag_.end = end + 1;
  return tag_;
}

std::string xml_text(std::string_view text) {
  constexpr std::array<std::pair<std::string_view, char>, 5> kEntities{
      {{"&lt;", '<'}, {"&gt;", '>'}, {"&amp;", '&'}, {"&quot;", '"'}, {"&apos;", '\''}}};
  std::string plain;
  while (!text.empty()) {
    const std::size_t amp = std::min(text.find('&'), text.size());
    plain += text.substr(0, amp);
    text.remove_prefix(amp);
    if (text.empty()) break;
    const auto entity = std::find_if(kEntities.begin(), kEntities.end(),
                                     [&](const auto& known) { return text.starts_with(known.first); });
    if (entity != kEntities.end()) {
      plain += entity->second;
      text.remove_prefix(entity->first.size());
      continue;
    }
    constexpr std::size_t kLongest = 12;
    const std::size_t end = text.substr(0, kLongest).find(';');
    if (!text.starts_with("&#") || end == std::string_view::npos) {
      plain += '&';
      text.remove_prefix(1);
      continue;
    }
    const bool is_hexadecimal = text[2] == 'x';
    std::uint32_t character = 0;
    std::from_chars(text.data() + (is_hexadecimal ? 3 : 2), text.data() + end, character, is_hexadecimal ? 16 : 10);
    append_character(plain, character);
    text.remove_prefix(end + 1);
  }
  return plain;
}

}  // namespace remesh
