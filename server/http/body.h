/// The body of a request, while it arrives and later when it is read. A large body is written to a temporary file
/// without a name, which is mapped once the body is complete. So bodies take no memory until the work begins, even if
/// the client never finishes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace remesh::server {

class Body {
 public:
  /// A body larger than this is stored in a file.
  static constexpr std::size_t kInMemory = 1 << 20;

  Body() = default;
  Body(Body&& other) noexcept { swap(other); }
  Body& operator=(Body&& other) noexcept {
    Body taken(std::move(other));
    swap(taken);
    return *this;
  }
  ~Body();

  /// Appends bytes.
  /// Errors: HttpError 503 `out_of_memory` - there is no room for the file.
  void append(std::string_view bytes);
  /// Marks the body as complete, so that it can be viewed.
  /// Errors: as above.
  void seal();
  /// Frees as much memory as possible until `seal` is called again. The body must not be viewed until then.
  void rest();

  /// The bytes of the body, which must be sealed.
  std::string_view view() const { return file_ < 0 ? std::string_view(text_) : std::string_view(mapped_, size_); }
  operator std::string_view() const { return view(); }
  std::size_t size() const { return size_; }
  bool is_in_file() const { return file_ >= 0; }

  void swap(Body& other) noexcept;

 private:
  void write_to_file(std::string_view bytes);
  void unmap();
  void record_unmapped(std::uint64_t bytes);

  std::size_t size_ = 0;
  std::string text_;  ///< the whole body if it is small
  int file_ = -1;
  bool is_in_memory_ = false;   ///< the file is in memory
  std::uint64_t unmapped_ = 0;  ///< bytes that count as those of a file in memory
  const char* mapped_ = nullptr;
};

}  // namespace remesh::server
