/// The rules by which details are removed.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/ids.h"
#include "core/base/vec.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// A triangulated surface, and how much of it may go. Lengths are in the unit of the positions, whose largest
/// coordinate is about 1.
struct DetailRules {
  std::span<const Vec3> positions;
  std::span<const Triangle> faces;
  std::span<const PatchId> patch;          ///< of each face; edges between patches are creases
  std::span<const std::uint32_t> label;    ///< of each face, or empty; edges between labels are borders, which stay
  std::span<const std::uint8_t> is_fixed;  ///< by vertex, or empty; 1: the vertex stays as it is
  double size = 0;     ///< edges shorter than this, and faces lower than this over a crease, are details
  double allowed = 0;  ///< no point of the surface moves by more than this
  double noise = 0;    ///< faces lower than this may look anywhere
  bool closes_narrow_notches = false;
};

}  // namespace remesh
