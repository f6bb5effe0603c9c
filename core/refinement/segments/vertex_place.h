/// The place of a vertex of a patch while the patch is refined.
#pragma once

#include <cassert>
#include <cstdint>

#include "core/refinement/goals/min_spacing.h"
#include "core/refinement/segments/segment_end.h"

namespace remesh {

/// A vertex belongs to the patch from the beginning, or lies on a segment at a parameter, or is free inside the patch.
/// There may be millions of vertices, so the parameter and the spacing share their memory. A vertex on a segment has a
/// parameter, and any other vertex has a spacing.
class VertexPlace {
 public:
  /// Makes the place of a vertex that the patch began with. It stays.
  static VertexPlace original(MinSpacing spacing) {
    return VertexPlace(Kind::kOriginal, SegmentId(), spacing.length, spacing.is_asked);
  }
  /// Makes the place of a cut.
  static VertexPlace on_segment(SegmentId segment, double t) {
    return VertexPlace(Kind::kOnSegment, segment, t, false);
  }
  /// Makes the place of a vertex that may be removed again.
  static VertexPlace free(MinSpacing spacing) {
    return VertexPlace(Kind::kFree, SegmentId(), spacing.length, spacing.is_asked);
  }

  bool is_original() const { return kind_ == Kind::kOriginal; }
  bool is_on_segment() const { return kind_ == Kind::kOnSegment; }
  bool is_free() const { return kind_ == Kind::kFree; }

  /// The vertex must be on a segment.
  SegmentId segment() const {
    assert(is_on_segment());
    return segment_;
  }
  /// The vertex must be on a segment.
  double parameter() const {
    assert(is_on_segment());
    return number_;
  }
  /// The vertex must not be on a segment, whose vertices all have the spacing of that segment.
  MinSpacing spacing() const {
    assert(!is_on_segment());
    return {number_, is_spacing_asked_};
  }

 private:
  enum class Kind : std::uint8_t { kOriginal, kOnSegment, kFree };

  VertexPlace(Kind kind, SegmentId segment, double number, bool is_spacing_asked)
      : number_(number), segment_(segment), kind_(kind), is_spacing_asked_(is_spacing_asked) {}

  double number_;  ///< the parameter on the segment, or else the length of the spacing
  SegmentId segment_;
  Kind kind_;
  bool is_spacing_asked_;
};

}  // namespace remesh
