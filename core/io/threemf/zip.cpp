#include "core/io/threemf/zip.h"

#include <zlib.h>

#include <algorithm>

#include "core/io/common/bytes.h"
#include "core/io/common/number_parsing.h"
#include "core/io/common/read_errors.h"

namespace remesh {
namespace {

constexpr std::string_view kEndMark("PK\5\6", 4);
constexpr std::string_view kEntryMark("PK\1\2", 4);
constexpr std::string_view kFileMark("PK\3\4", 4);
constexpr std::string_view kLargeEndMark("PK\6\6", 4);
constexpr std::uint32_t kInExtra = 0xffffffff;  ///< the number is one of 64 bits in the extra field

Error zip_error(std::size_t at, const std::string& message) {
  return read_error(Place::byte(at), Code::kInvalidMesh, message);
}

/// Ends inflate, whatever happens.
struct Inflation {
  z_stream stream{};
  ~Inflation() { inflateEnd(&stream); }
};

}  // namespace

ZipArchive::ZipArchive(std::string_view content) : content_(content) {
  constexpr std::size_t kEndSize = 22;
  const std::size_t end = content.rfind(kEndMark);
  if (end == std::string_view::npos || content.size() - end < kEndSize)
    throw zip_error(content.size(), "not a ZIP archive, or its end is missing");
  ByteReader tail(content, end + 10, ByteOrder::kLittle);
  std::uint64_t count = tail.take<std::uint16_t>();
  tail.skip(4);
  std::uint64_t directory = tail.take<std::uint32_t>();
  constexpr std::size_t kLocatorSize = 20;
  if (end >= kLocatorSize && content.substr(end - kLocatorSize, 4) == std::string_view("PK\6\7", 4)) {
    const std::uint64_t large_end =
        ByteReader(content, end - kLocatorSize + 8, ByteOrder::kLittle).take<std::uint64_t>();
    if (large_end > content.size() || content.substr(static_cast<std::size_t>(large_end), 4) != kLargeEndMark)
      throw zip_error(end, "a ZIP archive whose directory is not where it should be");
    ByteReader large(content, static_cast<std::size_t>(large_end), ByteOrder::kLittle);
    large.skip(32);
    count = large.take<std::uint64_t>();
    large.skip(8);
    directory = large.take<std::uint64_t>();
  }
  if (directory > content.size()) throw zip_error(end, "a ZIP archive whose directory is not where it should be");
  ByteReader bytes(content, static_cast<std::size_t>(directory), ByteOrder::kLittle);
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::size_t at = bytes.offset();
    if (content.substr(at, 4) != kEntryMark) throw zip_error(at, "a ZIP archive with a damaged directory");
    bytes.skip(8);
    Entry entry{};
    entry.flags = bytes.take<std::uint16_t>();
    entry.method = bytes.take<std::uint16_t>();
    bytes.skip(4);
    entry.checksum = bytes.take<std::uint32_t>();
    const auto packed_size = bytes.take<std::uint32_t>(), size = bytes.take<std::uint32_t>();
    const auto name_size = bytes.take<std::uint16_t>(), extra_size = bytes.take<std::uint16_t>(),
               comment_size = bytes.take<std::uint16_t>();
    bytes.skip(8);
    const auto offset = bytes.take<std::uint32_t>();
    const std::size_t name_begin = bytes.offset();
    bytes.skip(name_size);
    entry.name = content.substr(name_begin, name_size);
    entry.packed_size = packed_size;
    entry.size = size;
    entry.offset = offset;
    const std::size_t extra_end = bytes.offset() + extra_size;
    while (bytes.offset() + 4 <= extra_end) {
      const auto kind = bytes.take<std::uint16_t>(), length = bytes.take<std::uint16_t>();
      const std::size_t next = bytes.offset() + length;
      constexpr std::uint16_t kLargeNumbers = 1;
      if (kind == kLargeNumbers) {
        if (size == kInExtra) entry.size = bytes.take<std::uint64_t>();
        if (packed_size == kInExtra) entry.packed_size = bytes.take<std::uint64_t>();
        if (offset == kInExtra) entry.offset = bytes.take<std::uint64_t>();
      }
      if (next > extra_end || next < bytes.offset()) break;
      bytes.skip(next - bytes.offset());
    }
    if (bytes.offset() > extra_end) throw zip_error(at, "a ZIP archive with a damaged directory");
    bytes.skip(extra_end - bytes.offset() + comment_size);
    entries_.push_back(entry);
  }
}

const ZipArchive::Entry* ZipArchive::find(std::string_view name) const {
  while (name.starts_with('/')) name.remove_prefix(1);
  const auto is_alike = [](char a, char b) { return to_lower(a) == to_lower(b); };
  const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return std::equal(entry.name.begin(), entry.name.end(), name.begin(), name.end(), is_alike);
  });
  return found == entries_.end() ? nullptr : &*found;
}

std::string ZipArchive::read(std::string_view name, const DecompressionLimits& limits, RunControl& control) const {
  const Entry* const entry = find(name);
  if (entry == nullptr) throw zip_error(content_.size(), "the archive has no file " + cited(name));
  constexpr std::uint16_t kStored = 0, kDeflated = 8, kEncrypted = 1;
  if ((entry->flags & kEncrypted) != 0) throw zip_error(0, "the file " + cited(name) + " is encrypted");
  if (entry->method != kStored && entry->method != kDeflated)
    throw zip_error(0, "the file " + cited(name) + " is packed by the method " + std::to_string(entry->method));
  if (entry->offset > content_.size()) throw zip_error(content_.size(), "the file " + cited(name) + " is not there");
  ByteReader bytes(content_, static_cast<std::size_t>(entry->offset), ByteOrder::kLittle);
  if (content_.substr(bytes.offset(), 4) != kFileMark)
    throw zip_error(bytes.offset(), "the file " + cited(name) + " is not there");
  bytes.skip(26);
  const auto name_size = bytes.take<std::uint16_t>(), extra_size = bytes.take<std::uint16_t>();
  bytes.skip(std::uint64_t{name_size} + extra_size);
  const std::size_t begin = bytes.offset();
  if (entry->packed_size > bytes.left()) throw zip_error(begin, "the file " + cited(name) + " is cut short");
  const std::string_view packed = content_.substr(begin, static_cast<std::size_t>(entry->packed_size));

  // The size of the directory is not trusted: memory grows with what is unpacked.
  constexpr std::uint64_t kFree = std::uint64_t{1} << 20;
  const std::uint64_t by_ratio = std::max(kFree, limits.max_ratio * std::max<std::uint64_t>(packed.size(), 1));
  const std::uint64_t most = std::min(limits.max_bytes, by_ratio);
  if (entry->size > most) {
    throw read_error(Place::byte(begin), Code::kDecompressedTooLarge,
                     "the file " + cited(name) + " would have more than " + std::to_string(most) + " bytes")
        .with_limit(most);
  }
  std::string out;
  if (entry->method == kStored) {
    out = packed;
  } else {
    Inflation inflation;
    z_stream& stream = inflation.stream;
    if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) throw std::bad_alloc();
    std::size_t taken = 0;
    int status = Z_OK;
    while (status == Z_OK) {
      control.check();
      constexpr std::size_t kStep = 1 << 20;
      const std::size_t piece = std::min(kStep, packed.size() - taken), before = out.size();
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + taken));
      stream.avail_in = static_cast<uInt>(piece);
      const std::size_t room = std::min<std::size_t>(kStep, static_cast<std::size_t>(entry->size) + 1 - before);
      out.resize(before + room);
      stream.next_out = reinterpret_cast<Bytef*>(out.data() + before);
      stream.avail_out = static_cast<uInt>(room);
      status = inflate(&stream, Z_NO_FLUSH);
      taken += piece - stream.avail_in;
      out.resize(before + room - stream.avail_out);
      if (status == Z_OK && (out.size() > entry->size || (stream.avail_out > 0 && taken == packed.size()))) break;
    }
    if (status != Z_STREAM_END) throw zip_error(begin, "the file " + cited(name) + " is damaged");
  }
  const auto checksum = crc32_z(0, reinterpret_cast<const Bytef*>(out.data()), out.size());
  if (out.size() != entry->size || checksum != entry->checksum)
    throw zip_error(begin, "the file " + cited(name) + " is damaged");
  return out;
}

}  // namespace remesh
