#include "core/base/error.h"

namespace remesh {

std::string_view code_name(Code code) {
  switch (code) {
    case Code::kInvalidMesh: return "invalid_mesh";
    case Code::kIndexOutOfRange: return "index_out_of_range";
    case Code::kNonfiniteCoordinate: return "nonfinite_coordinate";
    case Code::kCoordinateRange: return "coordinate_range";
    case Code::kEmptyMesh: return "empty_mesh";
    case Code::kMeshTooLarge: return "mesh_too_large";
    case Code::kDecompressedTooLarge: return "decompressed_too_large";
    case Code::kOutputTooLarge: return "output_too_large";
    case Code::kInvalidOption: return "invalid_option";
    case Code::kUnsupportedMediaType: return "unsupported_media_type";
    case Code::kNotAcceptable: return "not_acceptable";
    case Code::kCancelled: return "cancelled";
    case Code::kTimeout: return "timeout";
    case Code::kOutOfMemory: return "out_of_memory";
    case Code::kVerificationFailed: return "verification_failed";
    case Code::kInternal: return "internal";
  }
  return "internal";
}

std::string_view stage_name(Stage stage) {
  switch (stage) {
    case Stage::kQueued: return "queued";
    case Stage::kRead: return "read";
    case Stage::kWeld: return "weld";
    case Stage::kRegions: return "regions";
    case Stage::kPatches: return "patches";
    case Stage::kLoops: return "loops";
    case Stage::kEssentialVertices: return "essential_vertices";
    case Stage::kSurfaces: return "surfaces";
    case Stage::kTriangulation: return "triangulation";
    case Stage::kRefinement: return "refinement";
    case Stage::kAssembly: return "assembly";
    case Stage::kVerify: return "verify";
    case Stage::kQuality: return "quality";
    case Stage::kWrite: return "write";
  }
  return "unknown";
}

}  // namespace remesh
