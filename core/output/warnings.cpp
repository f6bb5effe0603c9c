#include "core/output/warnings.h"

#include <algorithm>
#include <utility>

namespace remesh {
namespace {

/// A surface with fewer faces is a polyhedron. For example, each of a dozen polygons may have a patch of its own.
constexpr std::size_t kMinFacets = 50;

}  // namespace

void warn_of_curves(const Surface& surface, const PatchSet& patches, std::vector<Diagnostic>& diagnostics) {
  Diagnostic warning{DiagnosticCode::kCurvedSurface, 0, {}, ""};
  std::vector<FaceId> alone;  // ascending, because the patches' first faces are
  for (std::size_t p = 0; p < patches.count(); ++p) {
    const auto faces = patches.faces_of(PatchId(p));
    if (faces.size() == 1) alone.push_back(faces[0]);
  }
  if (2 * alone.size() <= surface.face_count() || surface.face_count() < kMinFacets) return;
  surface.for_each_source(alone, [&](FaceId source) { warning.add(source.value); });
  warning.message =
      "most facets are a patch of their own, which is typical of a curved surface; refinement makes many faces there";
  diagnostics.push_back(std::move(warning));
}

void warn_of_many_intersections(std::vector<Diagnostic>& diagnostics) {
  const auto is_of_them = [](const Diagnostic& d) {
    return d.code == DiagnosticCode::kSelfIntersection || d.code == DiagnosticCode::kOverlappingFaces;
  };
  auto found = std::find_if(diagnostics.begin(), diagnostics.end(), is_of_them);
  if (found == diagnostics.end())
    found = diagnostics.insert(diagnostics.end(), {DiagnosticCode::kSelfIntersection, 0, {}, "faces may intersect"});
  found->message += "; these are too many to test whether the result has others that the input does not have";
}

}  // namespace remesh
