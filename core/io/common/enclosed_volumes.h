/// The volumes that a surface encloses, for formats that tell a volume mesher what to fill.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/shells/shells.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// A closed shell that bounds a solid from outside, or a cavity.
struct EnclosedVolume {
  std::uint32_t shell;   ///< an index of Shells::all
  bool is_solid = true;  ///< false: the shell is the wall of a cavity, and its inside is empty
  /// The shells that lie directly inside this one. With it, they bound the volume.
  std::vector<std::uint32_t> shells_within;
};

struct EnclosedVolumes {
  Shells shells;
  std::vector<EnclosedVolume> all;  ///< a volume comes after those that it lies in
  /// True if every face belongs to a shell of these, and it is certain which shell lies in which.
  bool is_complete = false;
};

/// Finds the volumes that a surface encloses. A shell that faces inwards is a cavity, unless it lies in no other shell.
/// Output:  no volume at shells that are open or flat, that cross others, or of which several are in one place.
/// Holds:   the result is the same for any number of threads.
/// Errors:  kOutOfMemory - see MemoryBound; kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n) for separate shells; see ShellNesting.
EnclosedVolumes enclosed_volumes(const TriangleMesh& mesh, RunControl& control);

/// Finds a point inside of each volume, and outside of the shells within it. It is in the middle between two opposite
/// faces of the volume, one of which is the largest face of its shell.
/// Output:  one point for each of `volumes.all`.
/// Errors:  as enclosed_volumes.
/// Cost:    O(n log n), and for each volume the number of faces in one line with the point.
std::vector<Vec3> points_inside(const TriangleMesh& mesh, const EnclosedVolumes& volumes, RunControl& control);

}  // namespace remesh
