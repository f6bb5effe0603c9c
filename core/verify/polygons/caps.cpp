#include "core/verify/polygons/caps.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/stoppable.h"
#include "core/geometry/intersections/self_intersections.h"
#include "core/mending/polygons/polygon_split.h"
#include "core/verify/model/outline.h"

namespace remesh::verification {
namespace {

class CapCheck {
 public:
  CapCheck(const Claim& claim, const NumberedClaim& numbered, const EdgeTable& edges, RunControl& control)
      : claim_(claim), numbered_(numbered), edges_(edges), control_(control), is_cap_(claim.surface.face_count(), 0) {
    for (const FaceId cap : claim.surface.caps) is_cap_[cap.value] = 1;
  }

  void run(FoundFaults& faults) const {
    StopCheck check(control_);
    for (const FaceId cap : claim_.surface.caps) {
      check();
      if (!is_flat_cap(cap, check) || !is_rim_filled(cap, check)) add(cap, faults);
    }
    for (const FaceId cap : find_meeting_caps()) add(cap, faults);
  }

 private:
  void add(FaceId cap, FoundFaults& faults) const {
    faults.add(claim_.surface_patch[cap.value], Fault::kCap, claim_.surface.face_source[cap].value);
  }

  bool is_flat_cap(FaceId cap, StopCheck& check) const {
    std::vector<Vec3> loop;
    for (const VertexId v : numbered_.input.face(cap.value)) loop.push_back(numbered_.points[v.value]);
    const OutlineMeasures outline = measure_outline(loop, check);
    const Vec3 normal = normalized(outline.twice_area);
    if (normal == Vec3{}) return false;
    // If the corners are this near to each other along the direction, some plane across it has all of them within the
    // tolerance.
    double low = 0, high = 0;
    for (const Vec3& p : loop) {
      check();
      low = std::min(low, dot(p - loop[0], normal));
      high = std::max(high, dot(p - loop[0], normal));
    }
    return high - low <= 2 * numbered_.tolerance + 0x1p-45 * outline.length;
  }

  /// Returns whether the edges of a cap would be open without it, and whether the face that is its source is at one of
  /// them.
  bool is_rim_filled(FaceId cap, StopCheck& check) const {
    const std::uint32_t begin = numbered_.input.face_begin[cap.value], end = numbered_.input.face_begin[cap.value + 1];
    const auto face_of = [&](std::uint32_t half_edge) {
      const auto after =
          std::upper_bound(numbered_.input.face_begin.begin(), numbered_.input.face_begin.end(), half_edge);
      return FaceId(static_cast<std::size_t>(after - numbered_.input.face_begin.begin()) - 1);
    };
    bool is_source_at_rim = false;
    for (std::uint32_t h = begin; h < end; ++h) {
      check();
      const VertexId from = numbered_.input.corners[h], to = numbered_.input.corners[h + 1 == end ? begin : h + 1];
      if (edges_.count_uses(from, to) != 2) return false;
      const std::vector<Use> uses = edges_.find(from, to);
      if (uses[0].is_forward() == uses[1].is_forward()) return false;
      const FaceId other = face_of(uses[uses[0].half_edge == h ? 1 : 0].half_edge);
      if (other == cap) continue;
      if (is_cap_[other.value] != 0) return false;
      is_source_at_rim = is_source_at_rim || claim_.surface.face_source[other] == claim_.surface.face_source[cap];
    }
    return is_source_at_rim;
  }

  /// Finds the caps that meet faces elsewhere than in shared vertices and edges.
  std::vector<FaceId> find_meeting_caps() const {
    std::vector<Triangle> triangles;
    std::vector<FaceId> face;
    std::vector<std::uint32_t> piece;  // faces that are no caps are not compared with each other
    StopCheck check(control_);
    for (FaceId f(0); f.value < claim_.surface.face_count(); ++f.value)
      visit_triangles(claim_.surface, f, control_, [&](const Triangle& t) {
        check();
        triangles.push_back(t);
        face.push_back(f);
        piece.push_back(is_cap_[f.value] != 0 ? kNoPiece : 0);
      });
    const SearchLimits limits(SearchLimits::kEnoughPairs, SearchLimits::steps_for(triangles.size()));
    const SelfIntersections found =
        self_intersections(claim_.surface.positions.items(), triangles, piece, limits, control_);
    std::vector<FaceId> meeting;
    for (const auto& [f, g] : found.pairs)
      for (const FaceId of : {face[f.value], face[g.value]})
        if (is_cap_[of.value] != 0) meeting.push_back(of);
    return meeting;
  }

  const Claim& claim_;
  const NumberedClaim& numbered_;
  const EdgeTable& edges_;
  RunControl& control_;
  std::vector<std::uint8_t> is_cap_;
};

}  // namespace

void check_caps(const Claim& claim, const NumberedClaim& numbered, const EdgeTable& edges, FoundFaults& faults,
                RunControl& control) {
  const std::vector<FaceId>& caps = claim.surface.caps;
  if (claim.input == nullptr || caps.empty()) return;
  if (!std::is_sorted(caps.begin(), caps.end()) || caps.back().value >= claim.surface.face_count())
    return faults.add(PatchId(), Fault::kMalformed);
  CapCheck(claim, numbered, edges, control).run(faults);
}

}  // namespace remesh::verification
