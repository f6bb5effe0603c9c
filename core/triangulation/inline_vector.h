/// A vector that holds a few items within itself.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <type_traits>
#include <utility>

namespace remesh {

/// A vector of items that can be copied byte by byte. Up to `kInline` items need no memory of their own. A mesh may
/// have a million patches of one triangle each, and each of them has several vectors.
template <class T, std::uint32_t kInline>
class InlineVector {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  InlineVector() = default;
  InlineVector(const InlineVector& other) { assign(other.begin(), other.end()); }
  InlineVector(InlineVector&& other) noexcept { take(other); }
  InlineVector& operator=(const InlineVector& other) {
    if (this != &other) assign(other.begin(), other.end());
    return *this;
  }
  InlineVector& operator=(InlineVector&& other) noexcept {
    if (this == &other) return *this;
    release();
    take(other);
    return *this;
  }
  ~InlineVector() { release(); }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  std::size_t capacity() const { return capacity_; }
  T* data() { return data_; }
  const T* data() const { return data_; }
  T* begin() { return data_; }
  T* end() { return data_ + size_; }
  const T* begin() const { return data_; }
  const T* end() const { return data_ + size_; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  T& front() { return data_[0]; }
  const T& front() const { return data_[0]; }
  T& back() { return data_[size_ - 1]; }
  const T& back() const { return data_[size_ - 1]; }
  friend bool operator==(const InlineVector& a, const InlineVector& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end());
  }

  void clear() { size_ = 0; }
  /// Makes room for `n` items, and for no more than these.
  void reserve(std::size_t n) {
    if (n > capacity_) move_to(n);
  }
  void push_back(const T& item) { emplace_back(item); }
  template <class... Values>
  T& emplace_back(Values&&... values) {
    const T item{std::forward<Values>(values)...};  // it may be built of an item of this vector
    if (size_ == capacity_) move_to(std::size_t{2} * capacity_);
    return *std::construct_at(data_ + size_++, item);
  }
  void append(std::initializer_list<T> items) {
    for (const T& item : items) push_back(item);
  }
  void resize(std::size_t n, const T& item = {}) {
    reserve(n);
    if (n > size_) std::uninitialized_fill(data_ + size_, data_ + n, item);
    size_ = static_cast<std::uint32_t>(n);
  }
  void assign(std::size_t n, const T& item) {
    clear();
    resize(n, item);
  }
  template <class Iterator, class = std::enable_if_t<!std::is_integral_v<Iterator>>>
  void assign(Iterator first, Iterator last) {
    clear();
    reserve(static_cast<std::size_t>(last - first));
    std::uninitialized_copy(first, last, data_);
    size_ = static_cast<std::uint32_t>(last - first);
  }

 private:
  bool is_inline() const { return data_ == inline_data(); }
  const T* inline_data() const { return reinterpret_cast<const T*>(inline_); }
  T* inline_data() { return reinterpret_cast<T*>(inline_); }
  void release() {
    if (!is_inline()) std::allocator<T>().deallocate(data_, capacity_);
  }
  void move_to(std::size_t n) {
    T* const memory = std::allocator<T>().allocate(n);
    std::uninitialized_copy(begin(), end(), memory);
    release();
    data_ = memory;
    capacity_ = static_cast<std::uint32_t>(n);
  }
  /// Takes the items of another vector, which is then empty. This vector has no memory of its own.
  void take(InlineVector& other) {
    size_ = other.size_;
    capacity_ = other.capacity_;
    data_ = other.is_inline() ? inline_data() : other.data_;
    if (other.is_inline()) std::uninitialized_copy(other.begin(), other.end(), data_);
    other.data_ = other.inline_data();
    other.size_ = 0;
    other.capacity_ = kInline;
  }

  T* data_ = inline_data();
  std::uint32_t size_ = 0;
  std::uint32_t capacity_ = kInline;
  alignas(T) std::byte inline_[kInline * sizeof(T)];
};

}  // namespace remesh
