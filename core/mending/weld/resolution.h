/// Finds faces that coordinates cannot resolve at the scale of their mesh.
#pragma once

#include "core/base/error.h"
#include "core/base/ids.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Returns whether a face is so small or so thin that rounding at the mesh's scale decides where its corners are. This
/// is so if a side or a height of it is shorter than the last digit of the mesh's largest coordinate, or of the face's
/// own longest side. Such faces do no harm as long as they lie in a patch with others. Alone they may have no plane
/// that can be proven.
bool is_unresolved(const Surface& surface, FaceId f);

/// Makes the error for an unresolved face. It gives the face's number in the input, its measures, and advice.
Error unresolved(const Surface& surface, FaceId f);

}  // namespace remesh
