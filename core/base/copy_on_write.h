/// A vector that shares the items of another vector until the first change.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "core/base/ids.h"

namespace remesh {

/// A vector that refers to the items of another vector. The first change copies them.
/// Holds: the other vector's items outlive this object and do not change.
template <class Index, class T>
class CopyOnWrite {
 public:
  using value_type = T;
  using const_iterator = typename std::span<const T>::iterator;

  CopyOnWrite() = default;
  explicit CopyOnWrite(std::vector<T> own) : own_(std::move(own)), items_(own_) {}
  CopyOnWrite(const CopyOnWrite& other) : own_(other.own_), items_(other.is_own() ? own_ : other.items_) {}
  CopyOnWrite(CopyOnWrite&& other) noexcept
      : own_(std::move(other.own_)), items_(std::exchange(other.items_, std::span<const T>())) {}
  CopyOnWrite& operator=(CopyOnWrite other) noexcept {
    own_ = std::move(other.own_);  // moving the vector does not move its items in memory
    items_ = other.items_;
    return *this;
  }
  CopyOnWrite& operator=(std::vector<T> own) { return *this = CopyOnWrite(std::move(own)); }
  ~CopyOnWrite() = default;

  static CopyOnWrite of(std::span<const T> others) {
    CopyOnWrite items;
    items.items_ = others;
    return items;
  }

  const T& operator[](Index i) const { return items_[number(i)]; }
  std::size_t size() const { return items_.size(); }
  bool empty() const { return items_.empty(); }
  auto begin() const { return items_.begin(); }
  auto end() const { return items_.end(); }
  std::span<const T> items() const { return items_; }

  /// Calls `change` with the vector of items. Shared items are copied first.
  template <class Change>
  void change(const Change& change) {
    if (!is_own()) own_.assign(items_.begin(), items_.end());
    change(own_);
    items_ = own_;
  }
  /// Copies shared items, so that the vector refers to no other vector from now on.
  void detach() {
    change([](const std::vector<T>&) {});
  }

  friend bool operator==(const CopyOnWrite& a, std::span<const T> b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end());
  }

 private:
  static std::size_t number(std::size_t i) { return i; }
  template <class Tag>
  static std::size_t number(Id<Tag> id) {
    return id.value;
  }

  bool is_own() const { return items_.data() == own_.data(); }

  std::vector<T> own_;
  std::span<const T> items_;
};

}  // namespace remesh
