/// The one exception type of the library. An exception ends a request.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace remesh {

/// The kinds of errors that the core throws. Each code has a stable name in the contract (`code_name`). A library above
/// the core continues these numbers with codes of its own (api/request_code.h), since all errors are of the one type
/// Error. Two codes have the names that HTTP gives them, because the core throws them itself and the contract calls
/// them so: kUnsupportedMediaType for a format that is not read, kNotAcceptable for one that cannot hold a result.
enum class Code {
  kInvalidMesh,
  kIndexOutOfRange,
  kNonfiniteCoordinate,
  kCoordinateRange,
  kEmptyMesh,
  kMeshTooLarge,
  kDecompressedTooLarge,
  kOutputTooLarge,
  kInvalidOption,
  kUnsupportedMediaType,
  kNotAcceptable,
  kCancelled,
  kTimeout,
  kOutOfMemory,
  kVerificationFailed,
  kInternal,
};
inline constexpr int kCoreCodeCount = static_cast<int>(Code::kInternal) + 1;

/// The stages of the pipeline, in the order in which they run. Their names appear in progress, timings and errors.
enum class Stage {
  kQueued,
  kRead,
  kWeld,
  kRegions,
  kPatches,
  kLoops,
  kEssentialVertices,
  kSurfaces,
  kTriangulation,
  kRefinement,
  kAssembly,
  kVerify,
  kQuality,
  kWrite,
};
inline constexpr int kStageCount = static_cast<int>(Stage::kWrite) + 1;

/// The stable name of a code of the core, as in the contract: `invalid_mesh`.
std::string_view code_name(Code code);
/// The stable name of a stage: `read`, `weld`, ...
std::string_view stage_name(Stage stage);

/// Ends a request. All numbers that locate the fault are in the caller's numbering.
class Error : public std::runtime_error {
 public:
  Error(Code code, Stage stage, const std::string& message) : std::runtime_error(message), code(code), stage(stage) {}

  Error& at_line(std::uint64_t l) {
    line = l;
    return *this;
  }
  Error& at_byte(std::uint64_t b) {
    byte = b;
    return *this;
  }
  Error& at_element(std::uint64_t e) {
    element = e;
    return *this;
  }
  Error& for_option(std::string name) {
    option = std::move(name);
    return *this;
  }
  Error& with_limit(std::uint64_t l) {
    limit = l;
    return *this;
  }

  Code code;
  Stage stage;
  std::optional<std::uint64_t> line;     ///< line number from 1, in the text that was read
  std::optional<std::uint64_t> byte;     ///< byte offset from 0, in the binary data that was read
  std::optional<std::uint64_t> element;  ///< face or vertex of the input, from 0
  std::optional<std::uint64_t> limit;    ///< the limit that was exceeded
  std::string option;                    ///< the option at fault, by its name in the contract
};

}  // namespace remesh
