/// Compresses and decompresses gzip.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/run_control.h"
#include "core/io/common/format.h"

namespace remesh {

/// True if the data begins with gzip's magic bytes.
constexpr bool is_gzip(std::string_view content) { return content.starts_with("\x1f\x8b"); }

/// The max number of decompressed bytes that is permitted for this many compressed bytes.
std::uint64_t most_decompressed(std::uint64_t compressed, const DecompressionLimits& limits);

/// Decompresses gzip data of one or more consecutive members.
/// Errors:  kInvalidMesh, with the byte - not gzip, or data that is damaged, ends early or continues after the last
///          member; kDecompressedTooLarge - more than `limits`, found before more memory than they permit is taken;
///          kCancelled, kTimeout - through `control`.
/// Cost:    O(output), twice: the first pass counts, so that data that is refused takes no memory.
std::string gunzip(std::string_view content, const DecompressionLimits& limits, RunControl& control);

/// Compresses data.
/// Holds: equal content gives equal bytes; they contain no time and no name.
/// Errors:  kCancelled, kTimeout - through `control`.
std::string gzip(std::string_view content, RunControl& control);

}  // namespace remesh
