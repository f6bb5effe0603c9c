/// The choices of how a mesh is written. They change nothing of the mesh itself.
#pragma once

#include <string>

namespace remesh {

/// The labels that name the boundaries in formats with one label for each face.
enum class LabelChoice { kAuto, kObject, kGroup, kMaterial, kPatch, kSurface };

/// The names of boundaries in files for mesh programs.
enum class NameRule {
  kPortable,  ///< changed where a program could not read them; see portable_names
  kExact,     ///< as they came
};

/// The solids of text STL.
enum class StlSolids { kLabel, kOne };

/// The versions of Gmsh's format.
enum class MshVersion { k22, k41 };

/// The colours of faces in glTF.
enum class GlbColours {
  kLabel,    ///< the boundary of each face
  kQuality,  ///< the smallest angle of each face
};

struct Writing {
  LabelChoice label = LabelChoice::kAuto;
  NameRule names = NameRule::kPortable;
  StlSolids stl_solids = StlSolids::kLabel;
  MshVersion msh_version = MshVersion::k22;
  GlbColours glb_colours = GlbColours::kLabel;

  friend bool operator==(const Writing&, const Writing&) = default;
};

/// A name of a label that a file has in another form.
struct RenamedLabel {
  std::string from, to;

  friend bool operator==(const RenamedLabel&, const RenamedLabel&) = default;
};

}  // namespace remesh
