/// gzip, in and out.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/run_control.h"
#include "core/io/formats.h"

namespace remesh {

/// Whether data begins with gzip's mark.
constexpr bool is_gzip(std::string_view content) { return content.starts_with("\x1f\x8b"); }

/// How many bytes may come out of that many.
std::uint64_t most_decompressed(std::uint64_t compressed, const DecompressionLimits& limits);

/// Decompresses gzip data of one member or several, as they stand one behind the other.
/// Errors:  kInvalidMesh, with the byte - not gzip, data that is damaged, ends early or goes on behind the last member;
///          kDecompressedTooLarge - past `limits`, before more memory than they allow is taken; kCancelled, kTimeout -
///          through `control`.
/// Cost:    O(output), twice: what is to be refused is found before memory is taken for it.
std::string gunzip(std::string_view content, const DecompressionLimits& limits, RunControl& control);

/// Compresses. Holds: the same bytes for the same content; no time and no name is in them.
/// Errors:  kCancelled, kTimeout - through `control`.
std::string gzip(std::string_view content, RunControl& control);

}  // namespace remesh
