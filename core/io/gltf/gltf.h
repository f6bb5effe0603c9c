/// Reads and writes glTF 2.0.
#pragma once

#include <string>
#include <string_view>

#include "core/base/run_control.h"
#include "core/io/common/boundaries.h"
#include "core/io/common/format.h"

namespace remesh {

/// Returns whether a text looks like glTF as JSON, rather than like a mesh in JSON.
bool is_gltf_json(std::string_view text);

/// Reads binary glTF (`.glb`), and glTF as JSON with its buffers in data URIs.
/// Input:   triangles, strips and fans, indexed or not; positions of any type of numbers.
/// Output:  the triangles of all nodes of the first scene, with the nodes' transforms applied; of all nodes if there is
///          no scene. The names of meshes are objects, those of materials are materials. Points and lines, and meshes
///          with other attributes, skins or morph targets are counted as attribute_dropped. `unit` is `meter`, and
///          `up_axis` is `y`. A file by write_glb gives its own coordinates back instead.
/// Errors:  with the byte where it is known: kInvalidMesh - not glTF 2.0, a buffer in another file, a required
///          extension that is not known, sparse accessors, data that do not fit their accessor, nodes that are no tree;
///          kIndexOutOfRange, kNonfiniteCoordinate; kMeshTooLarge - more than `limits`, also by nodes that use a mesh
///          again. kEmptyMesh - no face; kCancelled, kTimeout - through `control`.
/// Cost:    O(content + output).
ReadResult read_gltf(std::string_view content, const ReadLimits& limits, RunControl& control);

/// Writes binary glTF to look at. Each boundary (boundaries.h) is a primitive with a material of its name and a colour
/// of its own; more than 256 boundaries share 256 colours. With GlbColours::kQuality there is one for each 5 degrees of
/// the smallest angle of a face instead, from red to green. All primitives use the same vertices. The coordinates are
/// the mesh's own; the transform of the only node turns the z axis upwards, unless that is y already, as in glTF.
/// `comments` are in the asset's extras.
/// Input:   `input.mesh` - all its coordinates must be floats (see round_for_format). They are not rounded here.
/// Errors:  kInternal - a coordinate is not a float; kOutputTooLarge - more bytes than the format can count;
///          kCancelled, kTimeout - through `control`.
/// Cost:    O(output).
std::string write_glb(const WriterInput& input, RunControl& control);

}  // namespace remesh
