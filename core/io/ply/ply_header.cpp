#include "core/io/ply/ply_header.h"

#include <algorithm>
#include <charconv>
#include <system_error>
#include <utility>

#include "core/io/common/number_parsing.h"
#include "core/io/common/read_errors.h"
#include "core/io/common/text_lines.h"

namespace remesh {
namespace {

/// These limits exceed every real file. Each property costs time for every record.
constexpr std::size_t kMaxProperties = 1024;
constexpr std::size_t kMaxElements = 64;
constexpr std::size_t kMaxComments = 1 << 16;

/// Parses the name of a type. Each type has two names.
std::optional<PlyType> type_from_name(std::string_view name) {
  constexpr std::pair<std::string_view, PlyType> kTypes[] = {
      {"char", PlyType::kInt8},      {"int8", PlyType::kInt8},       {"uchar", PlyType::kUint8},
      {"uint8", PlyType::kUint8},    {"short", PlyType::kInt16},     {"int16", PlyType::kInt16},
      {"ushort", PlyType::kUint16},  {"uint16", PlyType::kUint16},   {"int", PlyType::kInt32},
      {"int32", PlyType::kInt32},    {"uint", PlyType::kUint32},     {"uint32", PlyType::kUint32},
      {"float", PlyType::kFloat32},  {"float32", PlyType::kFloat32}, {"double", PlyType::kFloat64},
      {"float64", PlyType::kFloat64}};
  for (const auto& [known, type] : kTypes) {
    if (known == name) return type;
  }
  return std::nullopt;
}

class HeaderParser {
 public:
  explicit HeaderParser(std::string_view content) : content_(content), lines_(content) {}

  PlyHeader parse() {
    if (!lines_.next() || trim(lines_.line()) != "ply") {
      throw read_error(Place::line(1), Code::kInvalidMesh, "not PLY: the first line is not \"ply\"");
    }
    const bool has_lone_returns = lines_.offset() > 0 && content_[lines_.offset() - 1] == '\r';
    while (lines_.next()) {
      std::string_view rest = lines_.line();
      const std::string_view keyword = next_token(rest);
      if (keyword == "comment" || keyword == "obj_info") {
        if (!rest.empty()) rest.remove_prefix(1);
        if (keyword == "comment" && header_.comments.size() < kMaxComments) header_.comments.emplace_back(rest);
        continue;
      }
      lines_.check_is_text();
      if (keyword == "end_header") return finish(has_lone_returns);
      if (keyword == "format") {
        take_format(rest);
      } else if (keyword == "element") {
        take_element(rest);
      } else if (keyword == "property") {
        take_property(rest);
      } else if (!keyword.empty()) {
        throw error("not a line of a PLY header: " + cited(lines_.line()));
      }
    }
    throw error("the header has no \"end_header\"");
  }

 private:
  PlyHeader finish(bool has_lone_returns) {
    if (!has_format_) throw error("the header has no \"format\"");
    for (const PlyElement& element : header_.elements) {
      if (element.count > 0 && element.properties.empty()) {
        throw read_error(Place::line(element.line), Code::kInvalidMesh, "an element without properties");
      }
    }
    header_.size = lines_.offset();
    // If lines end in CR alone, an LF after the last one is the first byte of the data.
    if (has_lone_returns && content_[header_.size - 1] == '\n') --header_.size;
    header_.lines = lines_.number();
    return std::move(header_);
  }

  void take_format(std::string_view rest) {
    const std::string_view name = next_token(rest);
    if (has_format_) throw error("a second \"format\"");
    has_format_ = true;
    if (name == "ascii") {
      header_.encoding = PlyEncoding::kText;
    } else if (name == "binary_little_endian") {
      header_.encoding = PlyEncoding::kLittleEndian;
    } else if (name == "binary_big_endian") {
      header_.encoding = PlyEncoding::kBigEndian;
    } else {
      throw error("a format that is not known: " + cited(name));
    }
    if (next_token(rest) != "1.0") throw error("a version of PLY that is not 1.0");
  }

  void take_element(std::string_view rest) {
    PlyElement element;
    element.name = next_token(rest);
    const std::string_view count = next_token(rest);
    const char* const end = count.data() + count.size();
    const auto [stop, status] = std::from_chars(count.data(), end, element.count);
    if (element.name.empty() || status != std::errc() || stop != end) {
      throw error("an element takes a name and a count");
    }
    if (header_.elements.size() == kMaxElements) throw error("too many elements");
    for (const PlyElement& other : header_.elements) {
      if (other.name == element.name) throw error("the element " + cited(element.name) + " is declared twice");
    }
    element.line = lines_.number();
    header_.elements.push_back(std::move(element));
  }

  void take_property(std::string_view rest) {
    if (header_.elements.empty()) throw error("a property before the first element");
    PlyElement& element = header_.elements.back();
    PlyProperty property;
    std::string_view type = next_token(rest);
    if (type == "list") {
      property.count_type = take_type(next_token(rest));
      if (is_real(*property.count_type)) throw error("a list whose length is no whole number");
      type = next_token(rest);
    }
    property.type = take_type(type);
    property.name = next_token(rest);
    if (property.name.empty()) throw error("a property without a name");
    if (element.find(property.name)) throw error("the property " + cited(property.name) + " is declared twice");
    if (element.properties.size() == kMaxProperties) throw error("too many properties");
    element.properties.push_back(std::move(property));
  }

  PlyType take_type(std::string_view name) const {
    if (const auto type = type_from_name(name)) return *type;
    throw error("a type that is not known: " + cited(name));
  }

  Error error(const std::string& message) const {
    return read_error(Place::line(lines_.number()), Code::kInvalidMesh, message);
  }

  std::string_view content_;
  TextLines lines_;
  PlyHeader header_;
  bool has_format_ = false;
};

}  // namespace

std::size_t PlyElement::least_size() const {
  std::size_t size = 0;
  for (const PlyProperty& property : properties) size += size_of(property.count_type.value_or(property.type));
  return size;
}

bool PlyElement::has_lists() const {
  return std::any_of(properties.begin(), properties.end(), [](const PlyProperty& p) { return bool(p.count_type); });
}

std::optional<std::size_t> PlyElement::find(std::string_view property) const {
  for (std::size_t i = 0; i < properties.size(); ++i) {
    if (properties[i].name == property) return i;
  }
  return std::nullopt;
}

PlyHeader parse_ply_header(std::string_view content) { return HeaderParser(content).parse(); }

}  // namespace remesh
