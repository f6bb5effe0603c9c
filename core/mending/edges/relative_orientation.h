/// Tracks the relative orientation of the faces in each piece of a surface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/ids.h"

namespace remesh {

/// Knows which faces have the same orientation, as far as this follows from the edges over which they were joined.
class RelativeOrientation {
 public:
  explicit RelativeOrientation(std::size_t faces) : parent_(faces), size_(faces, 1), is_turned_(faces, 0) {
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

  /// Joins the pieces of two faces. `is_opposite` says whether the two faces have opposite orientations.
  void join(Side a, Side b, std::uint8_t is_opposite) {
    if (a.piece == b.piece) return;
    if (size_[a.piece] < size_[b.piece]) std::swap(a, b);
    parent_[b.piece] = a.piece;
    size_[a.piece] += size_[b.piece];
    is_turned_[b.piece] = a.is_turned ^ b.is_turned ^ is_opposite;
  }

 private:
  std::vector<std::uint32_t> parent_, size_;
  std::vector<std::uint8_t> is_turned_;  ///< whether the orientation of a face is opposite to that of its parent
};

}  // namespace remesh
