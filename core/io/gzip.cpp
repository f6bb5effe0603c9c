#include "core/io/gzip.h"

#include <zlib.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <new>
#include <vector>

#include "core/io/common/read_errors.h"

namespace remesh {
namespace {

constexpr int kGzipWindow = MAX_WBITS + 16;  // makes zlib accept gzip only
/// Number of bytes between two checks for cancellation, which take a few milliseconds.
constexpr std::size_t kStep = std::size_t{1} << 20;
/// Size of the buffer for bytes that are counted and then dropped.
constexpr std::size_t kPiece = std::size_t{1} << 16;
/// The ratio does not apply up to this size: a small file may be as regular as it likes.
constexpr std::uint64_t kFreeOfRatio = std::uint64_t{1} << 20;

const Bytef* bytes_of(std::string_view content) { return reinterpret_cast<const Bytef*>(content.data()); }

uInt bounded(std::size_t size) {
  return static_cast<uInt>(std::min<std::size_t>(size, std::numeric_limits<uInt>::max()));
}

class Inflater {
 public:
  Inflater() {
    if (inflateInit2(&stream_, kGzipWindow) != Z_OK) throw std::bad_alloc();
  }
  ~Inflater() { inflateEnd(&stream_); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  z_stream& stream() { return stream_; }

 private:
  z_stream stream_{};
};

class Deflater {
 public:
  Deflater() {
    constexpr int kMemoryLevel = 8;
    if (deflateInit2(&stream_, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kGzipWindow, kMemoryLevel, Z_DEFAULT_STRATEGY) !=
        Z_OK) {
      throw std::bad_alloc();
    }
  }
  ~Deflater() { deflateEnd(&stream_); }
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;

  z_stream& stream() { return stream_; }

 private:
  z_stream stream_{};
};

Error damaged(std::size_t offset, const std::string& message) {
  return read_error(Place::byte(offset), Code::kInvalidMesh, "gzip: " + message);
}

Error too_large(std::uint64_t most, const DecompressionLimits& limits) {
  const bool is_ratio = most < limits.max_bytes;
  return Error(Code::kDecompressedTooLarge, Stage::kRead,
               is_ratio ? "the data decompresses to more than " + std::to_string(limits.max_ratio) + " times its size"
                        : "the data decompresses to more than " + std::to_string(limits.max_bytes) + " bytes")
      .with_limit(is_ratio ? limits.max_ratio : limits.max_bytes);
}

/// The memory into which the next decompressed bytes are written.
struct Room {
  char* data;
  std::size_t size;
};

/// Decompresses all members.
/// Input: `take` - called with the number of bytes written to the last room; returns the next room, which is never
///        empty.
template <typename Take>
void inflate_members(std::string_view content, RunControl& control, const Take& take) {
  Inflater inflater;
  z_stream& stream = inflater.stream();
  Room room = take(0);
  for (std::size_t in_offset = 0;;) {
    control.progress(content.empty() ? 0 : static_cast<double>(in_offset) / static_cast<double>(content.size()));
    stream.next_in = const_cast<Bytef*>(bytes_of(content.substr(in_offset)));  // zlib does not write to it
    stream.avail_in = bounded(content.size() - in_offset);
    stream.next_out = reinterpret_cast<Bytef*>(room.data);
    stream.avail_out = bounded(room.size);
    const uInt given_in = stream.avail_in, given_out = stream.avail_out;
    const int status = inflate(&stream, Z_NO_FLUSH);
    in_offset += given_in - stream.avail_in;
    const bool is_full = stream.avail_out == 0;
    room = take(given_out - stream.avail_out);

    if (status == Z_STREAM_END) {
      // Padding with zeros, as tapes have it, is not a member.
      if (content.find_first_not_of('\0', in_offset) == std::string_view::npos) return;
      if (!is_gzip(content.substr(in_offset)))
        throw damaged(in_offset, "data that is not gzip follows the compressed data");
      if (inflateReset(&stream) != Z_OK) throw std::bad_alloc();
    } else if (status == Z_MEM_ERROR) {
      throw std::bad_alloc();
    } else if (status != Z_OK && status != Z_BUF_ERROR) {
      throw damaged(in_offset, stream.msg == nullptr ? "the data is damaged" : stream.msg);
    } else if (in_offset == content.size() && !is_full) {
      throw damaged(content.size(), "the data ends early");
    }
  }
}

}  // namespace

std::uint64_t most_decompressed(std::uint64_t compressed, const DecompressionLimits& limits) {
  const bool overflows =
      compressed > std::numeric_limits<std::uint64_t>::max() / std::max<std::uint64_t>(limits.max_ratio, 1);
  const std::uint64_t by_ratio = overflows ? limits.max_bytes : compressed * limits.max_ratio;
  return std::min(limits.max_bytes, std::max(by_ratio, kFreeOfRatio));
}

std::string gunzip(std::string_view content, const DecompressionLimits& limits, RunControl& control) {
  // The bytes are counted first. So data that is refused takes no memory, and other data takes no more than it needs.
  const std::uint64_t most = most_decompressed(content.size(), limits);
  std::vector<char> scratch(kPiece);
  std::uint64_t counted = 0;
  inflate_members(content, control, [&](std::size_t size) {
    counted += size;
    if (counted > most) throw too_large(most, limits);
    return Room{scratch.data(), scratch.size()};
  });

  // There is room for one byte more, so that the end is detected before the room is full.
  std::string out(static_cast<std::size_t>(counted) + 1, '\0');
  std::size_t used = 0;
  inflate_members(content, control, [&](std::size_t size) {
    used += size;
    return Room{out.data() + used, std::min(out.size() - used, kStep)};
  });
  out.resize(used);
  return out;
}

std::string gzip(std::string_view content, RunControl& control) {
  Deflater deflater;
  z_stream& stream = deflater.stream();
  std::string out;
  char buffer[1 << 16];
  std::size_t offset = 0;
  for (int status = Z_OK; status != Z_STREAM_END;) {
    if (stream.avail_in == 0) {
      control.check();
      const std::string_view piece = content.substr(offset, kStep);
      stream.next_in = const_cast<Bytef*>(bytes_of(piece));
      stream.avail_in = static_cast<uInt>(piece.size());
      offset += piece.size();
    }
    stream.next_out = reinterpret_cast<Bytef*>(buffer);
    stream.avail_out = sizeof buffer;
    status = deflate(&stream, offset == content.size() ? Z_FINISH : Z_NO_FLUSH);
    out.append(buffer, sizeof buffer - stream.avail_out);
  }
  return out;
}

}  // namespace remesh
