/// Visits the tags of XML without building a tree.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace remesh {

struct XmlTag {
  enum class Kind { kOpen, kClose, kEmpty, kEnd };
  Kind kind = Kind::kEnd;
  std::string_view name;        ///< without the prefix of a namespace
  std::string_view attributes;  ///< as they stand in the file
  std::size_t begin = 0;        ///< the offset of the tag
  std::size_t end = 0;          ///< the offset behind the tag

  bool opens(std::string_view element) const { return name == element && kind != Kind::kClose && kind != Kind::kEnd; }
  bool closes(std::string_view element) const { return name == element && kind == Kind::kClose; }
  /// The value of an attribute, as it stands in the file.
  std::optional<std::string_view> attribute(std::string_view attribute_name) const;
  /// Reads an attribute as a number.
  /// Errors: kInvalidMesh, with the byte - it is none.
  std::optional<std::uint64_t> number(std::string_view attribute_name) const;
};

/// Visits the tags in order. Comments, declarations and processing instructions are skipped. No entity is expanded but
/// by xml_text, and nothing outside of the text is opened.
/// Cost:    O(text).
class XmlTags {
 public:
  explicit XmlTags(std::string_view text) : text_(text) {}

  /// Goes to the next tag.
  /// Errors: kInvalidMesh, with the byte - a tag, comment or quote does not end.
  const XmlTag& next();
  const XmlTag& tag() const { return tag_; }
  /// The text between the last tag and the one before it.
  std::string_view text_before() const { return text_before_; }

 private:
  std::size_t find_end(std::size_t from) const;

  std::string_view text_;
  std::string_view text_before_;
  XmlTag tag_;
};

/// Replaces the entities of XML and the numbers of characters.
std::string xml_text(std::string_view text);

}  // namespace remesh
