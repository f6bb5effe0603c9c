/// The body of a request while it arrives, and then to be read. A large one lies in a temporary file without a name and
/// is mapped once it is whole: what clients send takes no memory until work begins, whether they end or not.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

namespace remesh::server {

class Body {
 public:
  /// What is larger goes to the file.
  static constexpr std::size_t kInMemory = 1 << 20;

  Body() = default;
  Body(Body&& other) noexcept { swap(other); }
  Body& operator=(Body&& other) noexcept {
    Body taken(std::move(other));
    swap(taken);
    return *this;
  }
  ~Body();

  /// Errors: HttpError 503 `out_of_memory` - there is no room for the file.
  void append(std::string_view bytes);
  /// Ends it, so that it can be viewed. Errors: as above.
  void seal();

  /// Of a body that has been sealed.
  std::string_view view() const { return file_ < 0 ? std::string_view(text_) : std::string_view(mapped_, size_); }
  operator std::string_view() const { return view(); }
  std::size_t size() const { return size_; }
  bool is_in_file() const { return file_ >= 0; }

  void swap(Body& other) noexcept;

 private:
  void write_to_file(std::string_view bytes);

  std::size_t size_ = 0;
  std::string text_;  ///< all of it of a small one
  int file_ = -1;
  const char* mapped_ = nullptr;
};

}  // namespace remesh::server
