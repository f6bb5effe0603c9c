/// All that the program knows about a mesh format, as one row of a table.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/ids.h"
#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/io/common/boundaries.h"
#include "core/io/common/format.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// A file's content, in the form in which the formats check whether it is theirs.
struct Sniffed {
  explicit Sniffed(std::string_view whole);

  std::string_view content;     ///< all bytes
  std::string_view text;        ///< `content` without its byte order mark
  std::string_view first_word;  ///< the first token of the text that is in no comment line
};

/// How strongly a content looks like a format.
enum class Mark {
  kNone,      ///< not at all
  kPossible,  ///< it may be this format if it is no other one
  kLikely,    ///< it begins as this format does
  kCertain,   ///< no other format looks like this, whatever its first words say
};

/// The labels that a format can hold.
enum class LabelsHeld {
  kNone,
  kOne,  ///< one label for each face: its boundary (boundaries.h)
  kAll,  ///< object, group and material of each face
};

/// A program that was seen to read the files of a format.
struct ReadingProgram {
  std::string_view program;
  std::string_view takes;      ///< what it takes of the file, in a few words
  std::string_view next = {};  ///< one to three lines of a shell that go on with a file `part`; empty if there are none
};

/// One format. One row is all that the code has to know of a format, so there are also things that only the API, the
/// daemon and the page use: the media type, and what people want to know of the file.
struct FormatSpec {
  std::string_view name;  ///< the stable name: `obj`
  /// The endings of files' names, without the point. What is written gets the first one; the others are only read.
  std::span<const std::string_view> endings;
  std::string_view media_type;
  Storage storage;                        ///< the numbers in which it is written
  LabelsHeld labels = LabelsHeld::kNone;  ///< those that it has when it is written
  std::string_view reads = {};            ///< what is read of such a file, in words; empty if it is only written
  std::string_view about = {};            ///< what is in a file that is written, in words; empty if it is only read
  std::span<const ReadingProgram> programs = {};  ///< empty if it is only read
  /// Looks at a content; null if the format is never recognised by its content.
  Mark (*mark)(const Sniffed& content) = nullptr;
  /// Null if the format is not read, or only above this library, as JSON is.
  ReadResult (*read)(std::string_view content, const ReadLimits& limits, RunControl& control) = nullptr;
  /// Null if the format is only read, or written only above this library, as JSON is.
  std::string (*write)(const WriterInput& input, RunControl& control) = nullptr;
  /// The names of labels that are changed when the mesh is written. Null if they are written as they came.
  std::vector<RenamedLabel> (*renamed)(const WriterInput& input, RunControl& control) = nullptr;
  /// The lines of Gmsh's language that fill a file of a closed surface. Null if Gmsh needs none or cannot fill it.
  std::vector<std::string> (*filling)(const WriterInput& input, RunControl& control) = nullptr;
};

const FormatSpec& format_spec(Format format);

}  // namespace remesh
