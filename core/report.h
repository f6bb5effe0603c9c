/// What a run tells about itself, as plain values. Field names are those of the contract's JSON report.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/ids.h"
#include "core/base/vec.h"
#include "core/options.h"

namespace remesh {

struct Range {
  double min = 0;
  double mean = 0;
  double max = 0;
};

/// `edges` has one entry more than `counts`; the first and last bins take what lies beyond.
struct Histogram {
  std::vector<double> edges;
  std::vector<std::uint64_t> counts;
};

/// Quality of a set of triangles, Verdict's definitions (Knupp et al., The Verdict Geometric Quality Library, 2007).
struct Quality {
  double min_angle_deg = 0;
  double max_angle_deg = 0;
  Range radius_edge_ratio;  ///< circumradius / shortest edge; 1/sqrt(3) for the equilateral triangle
  Range aspect_ratio;       ///< longest edge * perimeter / (4 sqrt(3) area); 1 for the equilateral triangle
  Range edge_length;
  Range area;
  Histogram angle_histogram_deg;
  Histogram radius_edge_histogram;
};

/// Counts and measures of a surface; `volume` is empty if it is open.
struct MeshStatistics {
  std::uint64_t vertices = 0;
  std::uint64_t faces = 0;
  std::uint64_t components = 0;
  std::uint64_t boundary_edges = 0;
  std::uint64_t non_manifold_edges = 0;
  bool closed = false;
  std::int64_t euler = 0;
  double area = 0;
  std::optional<double> volume;
  /// Pairs of faces that intersect; of the input as mended, and not those inside one large patch. Empty: not counted.
  std::optional<std::uint64_t> intersecting_pairs;
  Box3 bounding_box;
  Quality quality;
};

enum class PatchStatus { kRemeshed, kReduced, kKept };
enum class PatchReason : std::uint8_t {
  kNone,
  kSelfIntersectingLoop,
  kOverlappingFaces,
  kNotPlanar,
  kBudget,
  kVerificationFailed
};

struct PatchSummary {
  Vec3 normal;        ///< unit
  double offset = 0;  ///< normal . x = offset on the plane
  double area = 0;
  std::uint64_t input_faces = 0;
  std::uint64_t output_faces = 0;
  std::uint32_t loops = 0;
  std::uint32_t essential_vertices = 0;
  PatchStatus status = PatchStatus::kRemeshed;
  PatchReason reason = PatchReason::kNone;
  double deviation = 0;  ///< largest distance of an input vertex of the patch to its plane
};

enum class DiagnosticCode {
  kDuplicateVertex,
  kDuplicateFace,
  kZeroAreaFace,
  kTJunction,
  kInconsistentWinding,
  kInsideOut,
  kNonManifoldEdge,
  kNonManifoldVertex,
  kOpenBoundary,
  kSelfIntersection,
  kOverlappingFaces,
  kUnusedVertex,
  kNonplanarPolygon,
  kAttributeDropped,
  kTrailingBytes,
  kCurvedSurface,
  kSmallDihedral,
  kSeam,
  kRoundingCapped,
};

/// Something that was found, dropped, merged or split. `elements` holds the first 100, in the input's numbering from 0.
struct Diagnostic {
  static constexpr std::size_t kMaxElements = 100;

  DiagnosticCode code = DiagnosticCode::kDuplicateVertex;
  std::uint64_t count = 0;
  std::vector<std::uint64_t> elements;
  std::string message;

  /// Elements may come in any order: the first in the input's are kept, in that order.
  void add(std::uint64_t element) {
    ++count;
    if (elements.size() == kMaxElements) {
      if (element >= elements.back()) return;
      elements.pop_back();
    }
    elements.insert(std::upper_bound(elements.begin(), elements.end(), element), element);
  }
  /// Counts once for both, which are listed next to each other.
  void add_pair(std::uint64_t first, std::uint64_t second) {
    ++count;
    if (elements.size() + 2 <= kMaxElements) elements.insert(elements.end(), {first, second});
  }
};

/// Something that keeps a surface from bounding a volume. `places` holds the first 100: middles of edges, of faces, of
/// where two faces meet.
struct VolumeObstacle {
  static constexpr std::size_t kMaxPlaces = 100;

  DiagnosticCode code = DiagnosticCode::kOpenBoundary;
  std::uint64_t count = 0;
  std::vector<Vec3> places;

  void add(const Vec3& place) {
    ++count;
    if (places.size() < kMaxPlaces) places.push_back(place);
  }
  /// What comes after.
  void add(const VolumeObstacle& other) {
    count += other.count;
    const std::size_t more = std::min(kMaxPlaces - places.size(), other.places.size());
    places.insert(places.end(), other.places.begin(), other.places.begin() + static_cast<std::ptrdiff_t>(more));
  }
};

/// Why a triangle does not meet the bounds that refinement aims at.
enum class UnrefinedReason : std::uint8_t {
  kInputAngle,        ///< it fills a corner of the input: both its edges there are of the patch's boundary
  kAcrossInputAngle,  ///< its shortest edge joins two segments that meet under 60 degrees, as far from there on both
  kSizeFloor,         ///< a point that would mend it, or a size that it misses, is below the floor or below rounding
  kMinEdgeLength,     ///< the same for the option's floor
  kBudget,            ///< the result would have more faces than allowed
  kBoundaryLocked,    ///< a boundary would have to be split that must stay: as asked, or for a patch that stays
  kEffort,            ///< the work that is in proportion was spent before the bounds were met
  kOutputRounding,    ///< it met the bounds until its vertices were rounded to what the output format can hold
};
inline constexpr int kUnrefinedReasonCount = 8;

/// Triangles that refinement has left below its bounds. `places` holds the centroids of the first 100.
struct Unrefined {
  static constexpr std::size_t kMaxPlaces = 100;

  UnrefinedReason reason = UnrefinedReason::kInputAngle;
  std::uint64_t count = 0;
  std::vector<Vec3> places;

  void add(const Vec3& place) {
    ++count;
    if (places.size() < kMaxPlaces) places.push_back(place);
  }
};

/// What the independent checker found. `quality` is empty without refinement.
struct Verdict {
  bool surface = false;
  bool conforming = false;
  bool delaunay = false;
  std::optional<bool> quality;
  double deviation = 0;     ///< largest distance found between input and output
  double volume_bound = 0;  ///< of the change of volume, where both are closed: what deviations and rounding explain
  /// Patches on which a test failed, ascending; empty if only a property of the whole failed.
  std::vector<PatchId> failed_patches;
  /// Pairs of output faces that intersect, sorted; of very many just some.
  std::vector<std::pair<FaceId, FaceId>> intersections;
  /// False: input or output has too many of these to see for all of them whether their patches intersect in the input.
  bool are_all_intersections_known = true;
  /// The first failures in words, for logs and tests.
  std::vector<std::string> failures;

  bool all_true() const { return surface && conforming && delaunay && quality.value_or(true); }
};

struct StageTime {
  Stage stage;
  double ms;
};

struct Report {
  Options options;             ///< as used
  double plane_tolerance = 0;  ///< as used, model units
  bool plane_tolerance_is_automatic = true;
  double rounding_step = 0;  ///< to which coordinates are proven to be rounded; else the last place of the largest one
  double volume_bound = 0;   ///< of the change of volume: the verdict's; of an analysis, PatchSummaries'
  MeshStatistics input;
  MeshStatistics output;
  /// The largest distance by which the output format moved a vertex, model units; 0 if it holds all of them.
  double output_rounding = 0;
  /// The point that the written coordinates are relative to; empty if they are the model's own.
  std::optional<Vec3> output_origin;
  std::vector<PatchSummary> patches;
  std::vector<Diagnostic> diagnostics;
  std::vector<VolumeObstacle> volume_obstacles;  ///< of the result; of an analysis: of the input as mended
  std::uint64_t predicted_faces = 0;
  std::optional<double> smallest_gap;  ///< to the nearest facet that is not a neighbour, model units; see gap_search.h
  std::vector<Unrefined> unrefined;    ///< by reason, in the order of the enumeration; only those that occur
  std::uint32_t refinement_rounds = 0;
  Verdict verified;
  std::vector<StageTime> timing_ms;
};

std::string_view status_name(PatchStatus status);
/// The stable name; empty for kNone.
std::string_view reason_name(PatchReason reason);
std::string_view diagnostic_name(DiagnosticCode code);
std::string_view unrefined_name(UnrefinedReason reason);

}  // namespace remesh
