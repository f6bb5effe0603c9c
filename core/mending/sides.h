/// Which way pieces of a surface look.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/ids.h"

namespace remesh {

/// Which faces look the same way, as far as edges tell that they were joined over.
class Sides {
 public:
  explicit Sides(std::size_t faces) : parent_(faces), size_(faces, 1), is_turned_(faces, 0) {
    for (std::uint32_t f = 0; f < faces; ++f) parent_[f] = f;
  }

  struct Side {
    std::uint32_t piece;
    std::uint8_t is_turned;
  };
  Side of(FaceId face) const {
    Side side{face.value, 0};
    for (; parent_[side.piece] != side.piece; side.piece = parent_[side.piece])
      side.is_turned ^= is_turned_[side.piece];
    return side;
  }

  /// Joins the pieces of two faces, which look opposite ways or not.
  void join(Side a, Side b, std::uint8_t is_opposite) {
    if (a.piece == b.piece) return;
    if (size_[a.piece] < size_[b.piece]) std::swap(a, b);
    parent_[b.piece] = a.piece;
    size_[a.piece] += size_[b.piece];
    is_turned_[b.piece] = a.is_turned ^ b.is_turned ^ is_opposite;
  }

 private:
  std::vector<std::uint32_t> parent_, size_;
  std::vector<std::uint8_t> is_turned_;  ///< against the parent
};

}  // namespace remesh
