/// The boundaries of a mesh in formats that have one label for each face, and their names.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/run_control.h"
#include "core/io/common/format.h"
#include "core/io/common/write_text.h"

namespace remesh {

/// Makes names that every mesh program reads: ASCII letters, digits, `_`, `-` and `.`, 1 to 120 bytes, no two equal.
/// Each other character becomes a `_`, a longer name is cut, and an empty one becomes `unnamed`. A name that would be
/// the same as another one gets a number: `wall_2`.
/// Holds:  a name that needs no change keeps it, unless an earlier one is equal.
/// Cost:   O(n log n) for n bytes of names.
/// Source: the names that Gmsh, TetGen, Netgen, OpenFOAM, FreeFEM, VTK, FreeCAD and assimp were seen to read.
class PortableNames {
 public:
  static constexpr std::size_t kMaxLength = 120;

  /// Returns whether a name needs no change, apart from being the only one.
  static bool is_portable(std::string_view name);

  /// Takes a name if it is not taken yet.
  bool take(const std::string& name) { return taken_.insert(name).second; }
  /// Makes a name that is not taken yet, and takes it.
  std::string make(std::string_view name);

 private:
  std::set<std::string, std::less<>> taken_;
  /// The last number that was tried behind each name. Names that begin alike for so long that a number may replace
  /// where they differ count as one, so that no number is tried twice.
  std::map<std::string, std::uint64_t, std::less<>> last_number_;
};

/// The labels that divide a mesh into boundaries, and the names under which a format has them.
/// The labels are those that Writing::label asks for. If the mesh has none of these, its patches are the boundaries.
class Boundaries {
 public:
  /// The input must outlive this object.
  /// Input:  `exact_name` gives the form that the format can hold of any name.
  /// Errors: kCancelled, kTimeout - through `control`.
  /// Cost:   O(faces), and the names as in PortableNames.
  Boundaries(const WriterInput& input, RunControl& control,
             std::string (*exact_name)(std::string_view) = without_control_characters);

  /// The number of boundaries, with those that have no face.
  std::size_t size() const { return is_used_.size(); }
  std::uint32_t of(FaceId f) const {
    switch (choice_) {
      case LabelChoice::kPatch: return input_.face_patch[f].value;
      case LabelChoice::kSurface: return input_.surface_of_patch[input_.face_patch[f].value].value;
      default: return set_->of_face[f];
    }
  }
  bool has_faces(std::size_t boundary) const { return is_used_[boundary] != 0; }
  /// The name of a boundary that has faces.
  std::string name(std::size_t boundary) const;
  /// A name for something else in the same file.
  std::string other_name(std::string_view name) { return names_taken_.make(name); }
  const std::vector<RenamedLabel>& renamed() const { return renamed_; }

 private:
  LabelChoice choice_;
  const WriterInput& input_;
  const LabelSet* set_ = nullptr;      ///< null if patches or surfaces are the boundaries
  std::vector<std::uint8_t> is_used_;  ///< by boundary
  std::vector<std::string> names_;     ///< by boundary; empty if patches or surfaces are the boundaries
  PortableNames names_taken_;
  std::vector<RenamedLabel> renamed_;
};

/// Tells which names were changed, if there are any.
Diagnostic renamed_diagnostic(const std::vector<RenamedLabel>& renamed);

/// Appends a comment line for each boundary that has faces: `# WORD 1: NAME`. The numbers count from 1.
void append_names(std::string& out, std::string_view word, const Boundaries& boundaries, RunControl& control);

/// The labels of a mesh that a choice means, `auto`: groups, else objects, else materials.
/// Output: null if the mesh has none.
const LabelSet* chosen_labels(const FaceLabels& labels, LabelChoice choice);

}  // namespace remesh
