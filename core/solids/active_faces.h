/// Selects the faces of a soup that a search has to look at.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/mesh/mesh.h"
#include "core/solids/soup.h"

namespace remesh {

/// Some faces of a soup.
struct SelectedFaces {
  std::vector<FaceId> numbers;  ///< ascending; empty if all faces are selected
  std::vector<Triangle> copies;

  FaceId number(FaceId f) const { return numbers.empty() ? f : numbers[f.value]; }
  std::span<const Triangle> faces(const Soup& soup) const {
    return numbers.empty() ? std::span<const Triangle>(soup.faces) : std::span<const Triangle>(copies);
  }
};

/// Selects the active faces, and those whose boxes are within a distance of the box of an active face. So a search for
/// pairs with an active face need not look at the others.
/// Input:  `active` has one entry per face, or is empty: then all faces are selected.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n log a) for n faces of which a are active, and the pairs of boxes that meet.
SelectedFaces select_near_active(const Soup& soup, std::span<const std::uint8_t> active, double distance,
                                 RunControl& control);

}  // namespace remesh
