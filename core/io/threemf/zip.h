/// Reads the files of a ZIP archive.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/run_control.h"
#include "core/io/common/format.h"

namespace remesh {

/// An archive in memory. Its files are stored or packed by deflate.
/// Errors:  kInvalidMesh, with the byte - not a ZIP archive, or damaged.
class ZipArchive {
 public:
  explicit ZipArchive(std::string_view content);

  /// Output: true if there is a file of that name, in upper or lower case.
  bool has(std::string_view name) const { return find(name) != nullptr; }
  /// Unpacks a file.
  /// Errors: kInvalidMesh - there is none, it is encrypted, packed otherwise, or damaged; kDecompressedTooLarge - more
  ///         than the limits; kCancelled, kTimeout.
  std::string read(std::string_view name, const DecompressionLimits& limits, RunControl& control) const;

 private:
  struct Entry {
    std::string_view name;
    std::uint64_t packed_size, size, offset;
    std::uint32_t checksum;
    std::uint16_t method, flags;
  };
  const Entry* find(std::string_view name) const;

  std::string_view content_;
  std::vector<Entry> entries_;
};

}  // namespace remesh
