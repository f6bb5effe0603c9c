/// The mesh formats, and the types by which their readers and writers are called.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/ids.h"
#include "core/io/common/writing.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// All formats of the API. Each has a row in format_spec.cpp, in this order. All but 3MF, and the input files
/// of Abaqus and Nastran, can be written. A reader
/// treats both kinds of STL as kStl, and both kinds of PLY as kPly; kStlAscii and kPlyAscii only select how these are
/// written.
enum class Format {
  kObj,
  kJson,
  kStl,
  kStlAscii,
  kPly,
  kOff,
  kVtu,
  kMsh,
  kMesh,
  kSmesh,
  kPlyAscii,
  kGlb,
  kThreemf,
  kInp,
  kBdf
};

inline constexpr std::array kFormats = {Format::kObj,     Format::kJson,  Format::kStl,      Format::kStlAscii,
                                        Format::kPly,     Format::kOff,   Format::kVtu,      Format::kMsh,
                                        Format::kMesh,    Format::kSmesh, Format::kPlyAscii, Format::kGlb,
                                        Format::kThreemf, Format::kInp,   Format::kBdf};

/// Limits on decompressed data, with the service's defaults. More data ends the read with Code::kDecompressedTooLarge.
struct DecompressionLimits {
  std::uint64_t max_bytes = std::uint64_t{1} << 30;
  std::uint64_t max_ratio = 100;  ///< decompressed to compressed bytes; the first MiB is exempt
};

/// Limits on what a reader may build, with the defaults of the service, and what it looks for. A larger mesh ends the
/// read with Code::kMeshTooLarge.
struct ReadLimits {
  std::uint64_t max_vertices = 10'000'000;
  std::uint64_t max_faces = 20'000'000;
  DecompressionLimits decompression = {};  ///< of what is packed within the file
  /// The properties of faces in PLY that may be groups: the first one that a file has. Without a value these are the
  /// names that programs use.
  std::optional<std::vector<std::string>> ply_labels = {};
};

/// The input of a writer. Only the formats that have a place for them write the ids and the comments.
struct WriterInput {
  const TriangleMesh& mesh;
  const IdVector<FaceId, PatchId>& face_patch;
  const std::vector<std::string>& comments;
  /// The surface that each patch is a piece of; empty if it is not known.
  std::span<const SurfaceId> surface_of_patch = {};
  Writing writing = {};
  bool is_y_up = false;  ///< the axis that points upwards is y, as in the files of some formats
};

/// The result of a reader: the mesh, and diagnostics about what was dropped (`attribute_dropped`, ...).
struct ReadResult {
  PolygonMesh mesh;
  std::vector<Diagnostic> diagnostics;
  std::string unit = {};     ///< the unit of the coordinates, such as `meter`; empty if the format does not tell
  std::string up_axis = {};  ///< the axis that points upwards, such as `y`; empty if the format does not tell
};

}  // namespace remesh
