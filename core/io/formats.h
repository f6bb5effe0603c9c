/// Mesh formats: their names, telling them apart, reading and writing.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// Every format of the contract; what is known of each is a row in format_spec.cpp, in this order. All are written, all
/// but VTU and MSH are read. The two kinds of STL are one format to a reader, kStl: kStlAscii is only asked for.
enum class Format { kObj, kJson, kStl, kStlAscii, kPly, kOff, kVtu, kMsh };

inline constexpr std::array kFormats = {Format::kObj, Format::kJson, Format::kStl, Format::kStlAscii,
                                        Format::kPly, Format::kOff,  Format::kVtu, Format::kMsh};

/// The stable name: `obj`, `json`, ...
std::string_view format_name(Format format);
/// The usual ending of a file's name, without the point. It is the format's name, but for `stl_ascii`: `stl`.
std::string_view file_ending(Format format);
/// The numbers in which a format is written.
Storage storage_of(Format format);
/// The format of that very name.
std::optional<Format> format_from_name(std::string_view name);
/// By the ending of a file's name, in upper or lower case: `part.STL`, `part.obj.gz`. The directory does not count. Of
/// formats with one ending it is the first.
std::optional<Format> format_from_file_name(std::string_view file_name);
/// Whether a file's name ends in `.gz`.
bool is_gzip_file_name(std::string_view file_name);
/// The media type that answers carry, without parameters: `model/obj`.
std::string_view media_type(Format format);

/// The format that the content looks like, also one that is not read; OBJ if it looks like nothing else.
/// Input: the whole content, not compressed: binary STL has no mark, but a length and zero bytes.
/// Cost:  O(length).
Format sniff_format(std::string_view content);

/// What the content is, if its first bytes are the mark of a file that is none of our formats: "a ZIP archive, ...".
/// Input: the whole content, as for sniff_format.
std::optional<std::string_view> foreign_format(std::string_view content);

/// Bounds on what a reader may build; passing one ends the read with Code::kMeshTooLarge.
struct ReadLimits {
  std::uint64_t max_vertices = 10'000'000;
  std::uint64_t max_faces = 20'000'000;
};

/// Bounds on what compressed data may become; passing one ends the read with Code::kDecompressedTooLarge.
struct DecompressionLimits {
  std::uint64_t max_bytes = std::uint64_t{1} << 30;
  std::uint64_t max_ratio = 100;  ///< of the bytes out to the bytes in; the first MiB out is free of it
};

/// What a reader found: the mesh, and what it had to drop (`attribute_dropped`, ...).
struct ReadResult {
  PolygonMesh mesh;
  std::vector<Diagnostic> diagnostics;
};

}  // namespace remesh
