/// The mesh formats: their names, and how they are recognised.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/ids.h"
#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// All formats of the API. Each has a row in format_spec.cpp, in this order. All can be written; all but VTU and MSH
/// can be read. A reader treats both kinds of STL as kStl; kStlAscii only selects how STL is written.
enum class Format { kObj, kJson, kStl, kStlAscii, kPly, kOff, kVtu, kMsh };

inline constexpr std::array kFormats = {Format::kObj, Format::kJson, Format::kStl, Format::kStlAscii,
                                        Format::kPly, Format::kOff,  Format::kVtu, Format::kMsh};

/// The stable name of a format: `obj`, `json`, ...
std::string_view format_name(Format format);
/// The usual ending of a file name, without the point. It is the name of the format, except for `stl_ascii`, whose
/// ending is `stl`.
std::string_view file_ending(Format format);
/// The kind of numbers with which a format is written.
Storage storage_of(Format format);
/// The format of exactly that name.
std::optional<Format> format_from_name(std::string_view name);
/// The format for the ending of a file name, in upper or lower case: `part.STL`, `part.obj.gz`. The directory does
/// not matter. If several formats have the ending, it is the first one.
std::optional<Format> format_from_file_name(std::string_view file_name);
/// True if a file name ends in `.gz`.
bool is_gzip_file_name(std::string_view file_name);
/// The media type of answers, without parameters: `model/obj`.
std::string_view media_type(Format format);

/// The format that the content looks like, even one that cannot be read. It is OBJ if it looks like no other.
/// Input: the whole content, not compressed, because binary STL has no mark but its length and zero bytes.
/// Cost:  O(length).
Format sniff_format(std::string_view content);

/// Describes the content if its first bytes are the mark of a file that is none of our formats: "a ZIP archive, ...".
/// Input: the whole content, as for sniff_format.
std::optional<std::string_view> foreign_format(std::string_view content);

/// Limits on what a reader may build, with the defaults of the service. A larger mesh ends the read with
/// Code::kMeshTooLarge.
struct ReadLimits {
  std::uint64_t max_vertices = 10'000'000;
  std::uint64_t max_faces = 20'000'000;
};

/// Limits on decompressed data, with the service's defaults. More data ends the read with Code::kDecompressedTooLarge.
struct DecompressionLimits {
  std::uint64_t max_bytes = std::uint64_t{1} << 30;
  std::uint64_t max_ratio = 100;  ///< decompressed to compressed bytes; the first MiB is exempt
};

/// The input of a writer. Only the formats that have a place for them write the ids and the comments.
struct WriterInput {
  const TriangleMesh& mesh;
  const IdVector<FaceId, PatchId>& face_patch;
  const std::vector<std::string>& comments;
  /// The surface that each patch is a piece of; empty if it is not known.
  std::span<const SurfaceId> surface_of_patch = {};
};

/// The result of a reader: the mesh, and diagnostics about what was dropped (`attribute_dropped`, ...).
struct ReadResult {
  PolygonMesh mesh;
  std::vector<Diagnostic> diagnostics;
};

}  // namespace remesh
