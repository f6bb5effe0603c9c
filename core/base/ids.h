/// Ids of different kinds. The compiler does not accept one kind in place of another: a VertexId is no FaceId, and
/// neither is a number.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <ostream>
#include <type_traits>
#include <utility>
#include <vector>

namespace remesh {

/// The index that stands for "none", wherever an index of 32 bits may be missing.
inline constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// A 32-bit index of one kind. It is invalid by default, and prints as its prefix and number (`v12`).
template <class Tag>
struct Id {
  static constexpr std::uint32_t kInvalid = kNone;

  std::uint32_t value = kInvalid;

  constexpr Id() = default;
  constexpr explicit Id(std::uint32_t v) : value(v) {}
  constexpr explicit Id(std::size_t v) : value(static_cast<std::uint32_t>(v)) {}
  constexpr explicit Id(int v) : value(static_cast<std::uint32_t>(v)) {}

  constexpr bool is_valid() const { return value != kInvalid; }
  friend constexpr auto operator<=>(Id, Id) = default;
  friend std::ostream& operator<<(std::ostream& out, Id id) {
    return id.is_valid() ? out << Tag::kPrefix << id.value : out << Tag::kPrefix << '-';
  }
};

struct VertexTag {
  static constexpr char kPrefix = 'v';
};
struct FaceTag {
  static constexpr char kPrefix = 'f';
};
struct PatchTag {
  static constexpr char kPrefix = 'p';
};
struct SurfaceTag {
  static constexpr char kPrefix = 's';
};

using VertexId = Id<VertexTag>;
using FaceId = Id<FaceTag>;
using PatchId = Id<PatchTag>;
/// Stands for a surface that facets were made from (see recognised_surfaces.h), and not for a Surface.
using SurfaceId = Id<SurfaceTag>;

/// A vector that is indexed by one kind of id only.
template <class I, class T, class Allocator = std::allocator<T>>
class IdVector {
 public:
  using value_type = T;
  using Items = std::vector<T, Allocator>;

  IdVector() = default;
  explicit IdVector(std::size_t n, const T& value = T()) : items_(n, value) {}
  /// Makes `n` items as the allocator makes them. With DefaultInit, the caller has to set all of them.
  static IdVector of_size(std::size_t n) {
    IdVector vector;
    vector.items_ = Items(n);
    return vector;
  }

  typename Items::reference operator[](I id) { return items_[id.value]; }
  typename Items::const_reference operator[](I id) const { return items_[id.value]; }

  std::size_t size() const { return items_.size(); }
  bool empty() const { return items_.empty(); }
  void reserve(std::size_t n) { items_.reserve(n); }
  void resize(std::size_t n, const T& value = T()) { items_.resize(n, value); }
  void assign(std::size_t n, const T& value) { items_.assign(n, value); }
  void clear() { items_.clear(); }

  /// Appends an item and returns its id.
  I push_back(T item) {
    items_.push_back(std::move(item));
    return I(items_.size() - 1);
  }

  auto begin() { return items_.begin(); }
  auto end() { return items_.end(); }
  auto begin() const { return items_.begin(); }
  auto end() const { return items_.end(); }

  /// The items as a plain vector, for code that loops over all of them or moves them out.
  Items& items() { return items_; }
  const Items& items() const { return items_; }

  friend bool operator==(const IdVector&, const IdVector&) = default;

 private:
  Items items_;
};

/// Allocates memory without initialising it. Many threads that each fill a part need not wait until one has cleared it
/// all.
template <class T>
struct DefaultInit : std::allocator<T> {
  static_assert(std::is_trivially_copyable_v<T>);
  template <class U>
  struct rebind {
    using other = DefaultInit<U>;
  };
  void construct(T*) {}
  template <class... Arguments>
  void construct(T* at, Arguments&&... arguments) {
    std::construct_at(at, std::forward<Arguments>(arguments)...);
  }
};

/// An IdVector that many threads fill.
template <class I, class T>
using FilledIdVector = IdVector<I, T, DefaultInit<T>>;

}  // namespace remesh
