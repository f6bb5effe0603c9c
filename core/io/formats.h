/// The mesh formats: their names, and how they are recognised.
#pragma once

#include <optional>
#include <string_view>

#include "core/base/options.h"
#include "core/io/common/format.h"

namespace remesh {

/// True if a format can be written; false if it is only read.
bool is_written(Format format);
/// The stable name of a format: `obj`, `json`, ...
std::string_view format_name(Format format);
/// The ending of the name of a file that is written, without the point. It is the name of the format, except for
/// `stl_ascii` and `ply_ascii`, whose endings are `stl` and `ply`.
std::string_view file_ending(Format format);
/// The kind of numbers with which a format is written.
Storage storage_of(Format format);
/// The format of exactly that name.
std::optional<Format> format_from_name(std::string_view name);
/// The format of a file by the ending of its name, in upper or lower case: `part.STL`, `part.obj.gz`. The directory
/// does not matter. If several formats have the ending, it is the first one.
std::optional<Format> format_from_file_name(std::string_view file_name);
/// The same for a file that is to be written. Nothing if only files of another ending are written, as for `part.vtp`.
std::optional<Format> written_format_from_file_name(std::string_view file_name);
/// True if a file name ends in `.gz`.
bool is_gzip_file_name(std::string_view file_name);
/// The media type of answers, without parameters: `model/obj`.
std::string_view media_type(Format format);

/// The format that the content looks like, even one that cannot be read. It is OBJ if it looks like no other.
/// Input: the whole content, not compressed, because binary STL has no mark but its length and zero bytes.
/// Cost:  O(length).
Format sniff_format(std::string_view content);

}  // namespace remesh
