/// Files that users often take for meshes, or for meshes that we read.
#pragma once

#include <optional>
#include <span>
#include <string_view>

namespace remesh {

/// One kind of file that is not read. A new reader takes the row of its format out of the table.
struct ForeignFile {
  std::string_view begin;   ///< the first bytes, in lower case
  std::string_view within;  ///< what also occurs among the first kilobytes, as it stands there; may be empty
  std::string_view name;    ///< what it is: "STEP, ..."
  std::string_view next;    ///< what to do with it, as a command if there is one
  /// Looks at the text in place of `begin`, if the first bytes are not always the same.
  bool (*is_it)(std::string_view text) = nullptr;
};

/// All kinds, in the order in which they are looked for.
std::span<const ForeignFile> foreign_files();

/// Finds the kind of a content by its first bytes.
/// Input:  the whole content, not compressed.
/// Output: null if it may be one of our formats.
const ForeignFile* foreign_file(std::string_view content);

}  // namespace remesh
