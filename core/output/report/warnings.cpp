#include "core/output/report/warnings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "core/base/number_text.h"
#include "core/output/report/surface_words.h"

namespace remesh {
namespace {

/// A surface with fewer faces is a polyhedron. For example, each of a dozen polygons may have a patch of its own.
constexpr std::size_t kMinFacets = 50;

constexpr std::size_t kKinds = static_cast<std::size_t>(SurfaceKind::kFree) + 1;

/// Joins the counts of all kinds but planes: `14 cylinders, 28 cones and 1 free region`.
std::string list_counts(const std::array<std::uint64_t, kKinds>& counts) {
  std::vector<std::string> parts;
  for (std::size_t kind = 0; kind < kKinds; ++kind) {
    if (counts[kind] > 0 && static_cast<SurfaceKind>(kind) != SurfaceKind::kPlane)
      parts.push_back(count_text(counts[kind], static_cast<SurfaceKind>(kind)));
  }
  std::string text;
  for (std::size_t i = 0; i < parts.size(); ++i)
    text += (i == 0 ? "" : i + 1 == parts.size() ? " and " : ", ") + parts[i];
  return text;
}

std::string faces_text(double faces, RefinedFaces::Are are) {
  if (are == RefinedFaces::Are::kCounted) return "made " + grouped_digits(static_cast<std::uint64_t>(faces));
  return "makes " + about(faces);
}

std::string elements_text() { return "elements_per_circle=" + std::to_string(kAdvisedElements); }

/// Names the options that help: for surfaces whose facets stay flat, and for free regions.
std::string advice(bool is_any_curved, bool is_any_free, const FreeAdvice& free) {
  std::string text;
  if (is_any_curved)
    text =
        "; another surface_tolerance (above 0), elements_per_circle or feature_angle_deg may let curved surfaces be "
        "remeshed as a whole";
  if (!is_any_free) return text;
  if (free.may_be_coarser) {
    text +=
        "; surface_tolerance (above 0) or elements_per_circle makes free regions coarser, within a proven distance of "
        "the "
        "input";
    if (free.faces) text += " (" + elements_text() + " makes " + about(*free.faces) + " faces of them)";
  }
  return text + "; another feature_angle_deg may let a free region be recognised as a cylinder, cone, sphere or torus";
}

}  // namespace

void warn_of_curved_surfaces(const Surface& surface, const PatchSet& patches, const RecognisedSurfaces& recognised,
                             const RefinedFaces& refined, std::vector<Diagnostic>& diagnostics,
                             const CurvedPatches* curved, const FreeAdvice& free) {
  const auto is_curved = [&](PatchId p) {
    if (curved != nullptr && curved->of(p) != nullptr) return false;
    const SurfaceKind kind = recognised.surfaces[recognised.of_patch[p]].shape.kind;
    return kind != SurfaceKind::kPlane && (free.are_told || kind != SurfaceKind::kFree);
  };
  std::array<std::uint64_t, kKinds> counts{};
  for (const RecognisedSurface& found : recognised.surfaces) ++counts[static_cast<std::size_t>(found.shape.kind)];
  const std::uint64_t planes = counts[static_cast<std::size_t>(SurfaceKind::kPlane)];
  const std::uint64_t free_regions = counts[static_cast<std::size_t>(SurfaceKind::kFree)];
  std::uint64_t facets = 0;
  double faces = 0;
  for (std::size_t p = 0; p < patches.count(); ++p) {
    if (!is_curved(PatchId(p))) continue;
    ++facets;
    faces += refined.of_patch(PatchId(p));
  }
  const bool is_any_curved = planes + free_regions < recognised.surfaces.size();
  if (facets == 0 || (!is_any_curved && facets < kMinFacets)) return;

  Diagnostic warning{DiagnosticCode::kCurvedSurface, 0, {}, ""};
  FaceId last;
  for (std::size_t f = 0; f < surface.face_count(); ++f) {
    const FaceId source = surface.face_source[FaceId(f)];
    if (source == last || !is_curved(patches.of_face[FaceId(f)])) continue;
    warning.add(source.value);
    last = source;
  }
  warning.message = "found " + list_counts(counts) + ", made of " + grouped_digits(facets) +
                    " facets; each stays flat as a patch of its own, and refinement " + faces_text(faces, refined.are) +
                    " faces of them" + advice(is_any_curved, free_regions > 0, free);
  if (is_any_curved && curved == nullptr)
    warning.remedies.push_back({elements_text(), "would remesh curved surfaces as a whole"});
  else if (free_regions > 0 && free.may_be_coarser)
    warning.remedies.push_back({elements_text(), "would make free regions coarser"});
  diagnostics.push_back(std::move(warning));
}

void report_coarsened_surfaces(const Surface& surface, const PatchSet& patches, const CurvedPatches* curved,
                               RefinedFaces::Are are, Report& report) {
  if (curved == nullptr || !are_fine_facets_coarsened(report.options)) return;
  Diagnostic told{DiagnosticCode::kCurvedSurface, 0, {}, ""};
  FaceId last;
  for (std::size_t f = 0; f < surface.face_count(); ++f) {
    const FaceId source = surface.face_source[FaceId(f)];
    if (source == last || curved->of(patches.of_face[FaceId(f)]) == nullptr) continue;
    told.add(source.value);
    last = source;
  }
  std::array<std::uint64_t, kKinds> counts{};
  std::uint64_t count = 0;
  double elements = 0;
  for (const RecognisedSurface& s : report.surfaces.surfaces) {
    if (!s.is_remeshed || !s.elements_per_circle) continue;
    ++counts[static_cast<std::size_t>(s.shape.kind)];
    ++count;
    elements = *s.elements_per_circle;
  }
  if (count == 0) return;
  const bool is_done = are == RefinedFaces::Are::kCounted;
  told.message = "elements_per_circle=auto " + std::string(is_done ? "remeshed " : "remeshes ") + list_counts(counts) +
                 (count == 1 ? ", which has" : ", which have") + " more than 32 facets per turn, with " +
                 grouped_digits(static_cast<std::uint64_t>(elements)) + " edges per turn";
  if (is_done && report.input.volume && report.output.volume)
    told.message +=
        "; the volume was " + number_text(*report.input.volume, 7) + " and is " + number_text(*report.output.volume, 7);
  told.message += "; elements_per_circle=none or preset=exact keeps the facets";
  if (report.options.circle_fit != CircleFit::kVolume) told.message += ", and circle_fit=volume keeps the volume";
  report.diagnostics.push_back(std::move(told));
}

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
      "most facets are a patch of their own, which is typical of a curved surface; refinement makes many faces there; "
      "a feature_angle_deg above 0 lets curved surfaces be recognised and remeshed as a whole";
  diagnostics.push_back(std::move(warning));
}

void warn_of_many_intersections(std::vector<Diagnostic>& diagnostics) {
  auto found = std::find_if(diagnostics.begin(), diagnostics.end(),
                            [](const Diagnostic& d) { return d.code == DiagnosticCode::kIncompleteCheck; });
  if (found == diagnostics.end())
    found = diagnostics.insert(
        diagnostics.end(),
        {DiagnosticCode::kIncompleteCheck, 1, {}, "the result has more intersections than are listed"});
  found->message += "; whether the result has intersections that the input does not have was not tested for all faces";
}

}  // namespace remesh
