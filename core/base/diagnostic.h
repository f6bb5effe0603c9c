/// The findings about an input and the repairs that followed, as the report lists them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace remesh {

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
  kClosedHole,
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
  kManyFaces,
  kIncompleteCheck,
  kRemovedDetail,
  kSmallDetail,
  kOutputAsText,
  kRenamedLabels,
  kCutIntersections,
  kSharedFaces,
  kDroppedPieces,
};

/// Options that would help, and what they would do.
struct Remedy {
  std::string options;  ///< as in a query: `repair=+holes&max_hole_edges=40`
  std::string effect;   ///< what follows from them, as the end of a sentence: `would give about 900 faces`
};

/// A part of a message, and the remedies that it names.
struct Advice {
  std::string text;
  std::vector<Remedy> remedies;
};

/// Something that was found, dropped, merged or split. `elements` has the first 100, in the input's numbering from 0.
struct Diagnostic {
  static constexpr std::size_t kMaxElements = 100;

  DiagnosticCode code = DiagnosticCode::kDuplicateVertex;
  std::uint64_t count = 0;
  std::vector<std::uint64_t> elements;
  std::string message;
  std::vector<Remedy> remedies{};  ///< those that help most come first

  void add(Advice advice) {
    message += advice.text;
    for (Remedy& remedy : advice.remedies) remedies.push_back(std::move(remedy));
  }
  /// Elements may be added in any order. The list has the smallest of them, in ascending order.
  void add(std::uint64_t element) {
    ++count;
    if (elements.size() == kMaxElements) {
      if (element >= elements.back()) return;
      elements.pop_back();
    }
    elements.insert(std::upper_bound(elements.begin(), elements.end(), element), element);
  }
  /// Counts a pair as one, and lists its two elements next to each other.
  void add_pair(std::uint64_t first, std::uint64_t second) {
    ++count;
    if (elements.size() + 2 <= kMaxElements) elements.insert(elements.end(), {first, second});
  }
};

/// The stable name of a code.
std::string_view diagnostic_name(DiagnosticCode code);

}  // namespace remesh
