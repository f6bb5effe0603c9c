#include "core/verify/polygons/polygon_cover_check.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"
#include "core/verify/model/outline.h"

namespace remesh::verification {
namespace {

/// The faces [begin, end) of the surface, which were made of one polygon of the input.
struct PolygonFaces {
  std::size_t begin, end;
  FaceId source;
};

/// A polygon whose faces do not cover exactly the area inside its outline. Whether that is wrong depends on the
/// outline.
struct Doubt {
  PolygonFaces faces;
  std::uint64_t pairs;  ///< number of pairs of edges to compare
};

class PolygonCheck {
 public:
  PolygonCheck(const Claim& claim, const NumberedClaim& numbered, RunControl& control)
      : claim_(claim), numbered_(numbered), control_(control) {
    // Mending moves corners at most twice, and welding moves them once.
    moved_ = 2 * numbered.tolerance + numbered.scale * claim.weld_tolerance;
  }

  void run(std::uint64_t max_pairs, FoundFaults& faults) {
    // The polygons that are not tested are the last ones in the order of the file, whatever the threads do.
    std::vector<Doubt> affordable;
    StopCheck check(control_);
    for (const std::vector<Doubt>& block : find_doubts())
      for (const Doubt& doubt : block) {
        check();
        if (doubt.pairs > max_pairs) continue;
        max_pairs -= doubt.pairs;
        affordable.push_back(doubt);
      }
    constexpr std::size_t kDoubtsPerBlock = 16;
    std::vector<std::uint8_t> are_wrong(affordable.size(), 0);
    for_blocks(affordable.size(), kDoubtsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) are_wrong[i] = is_wrong(affordable[i]);
    });
    for (std::size_t i = 0; i < affordable.size(); ++i) {
      check();
      const PolygonFaces& faces = affordable[i].faces;
      if (are_wrong[i] != 0) faults.add(claim_.surface_patch[faces.begin], Fault::kPolygon, faces.source.value);
    }
  }

 private:
  /// An outline in its plane, without its spikes.
  struct Outline {
    std::vector<Vec3> loop;
    Vec3 normal;
    double reach;
  };

  std::vector<std::vector<Doubt>> find_doubts() const {
    constexpr std::size_t kFacesPerBlock = 1024;
    const std::size_t faces = claim_.surface.face_count();
    const auto source = [&](std::size_t f) { return claim_.surface.face_source[FaceId(f)]; };
    return map_blocks<std::vector<Doubt>>(faces, kFacesPerBlock, control_, [&](std::size_t first, std::size_t last) {
      std::vector<Doubt> found;
      StopCheck check(control_);
      // The faces of one polygon are consecutive. They belong to the block in which they begin.
      std::size_t begin = first;
      while (begin > 0 && begin < last && source(begin) == source(begin - 1)) ++begin;
      for (std::size_t end = begin; begin < last; begin = end) {
        for (end = begin + 1; end < faces && source(end) == source(begin); ++end) check();
        check();
        if (source(begin).value >= claim_.input->face_count() || claim_.input->face(source(begin)).size() <= 3)
          continue;
        const PolygonFaces of_polygon{begin, end, source(begin)};
        if (auto outline = outline_in_doubt(of_polygon, check))
          found.push_back({of_polygon, simple(*std::move(outline)).pair_count()});
      }
      return found;
    });
  }

  SimpleOutline simple(Outline outline) const {
    return {std::move(outline.loop), outline.normal, outline.reach, control_};
  }

  bool is_wrong(const Doubt& doubt) const {
    StopCheck check(control_);
    auto outline = outline_in_doubt(doubt.faces, check);
    return outline && simple(*std::move(outline)).is_simple(control_);
  }

  /// Compares the faces that were made of a polygon with the polygon's outline.
  /// Output: the outline, if the faces do not cover exactly the area inside it; nothing if they do, or if the polygon
  ///         is too bent to judge. Faces that do not cover this area are a fault if the outline is simple. If the
  ///         outline touches or crosses itself, the faces may be right.
  std::optional<Outline> outline_in_doubt(const PolygonFaces& faces, StopCheck& check) const {
    std::vector<Vec3> loop, face;
    for (const VertexId v : claim_.input->face(faces.source)) {
      check();
      loop.push_back(numbered_.scale * claim_.input->positions[v]);
    }
    const OutlineMeasures outline = measure_outline(loop, check);
    Vec3 twice_sum;
    double twice_covered = 0, magnitude = outline.magnitude;
    for (std::size_t f = faces.begin; f < faces.end; ++f) {
      // A face that closes a hole has the source of a face beside it.
      if (std::binary_search(claim_.surface.caps.begin(), claim_.surface.caps.end(), FaceId(f))) continue;
      face.clear();
      for (const VertexId v : numbered_.input.face(f)) face.push_back(numbered_.points[v.value]);
      const OutlineMeasures of_face = measure_outline(face, check);
      twice_sum += of_face.twice_area;
      twice_covered += norm(of_face.twice_area);
      magnitude += of_face.magnitude;
    }
    const double twice_area = norm(outline.twice_area);
    const double allowed = 2 * moved_ * outline.length + 0x1p-45 * magnitude;
    const bool is_area_equal = std::fabs(norm(twice_sum) - twice_area) <= allowed;
    if (is_area_equal && twice_covered <= twice_area + allowed) return {};
    const double reach = moved_ + 0x1p-45 * outline.length;
    // Mending cuts off every spike up to half the width that it may cut. An outline with a wider spike is not clearly
    // simple within the reach, so it is not judged, whether or not mending has cut the spike off.
    const double spike = numbered_.tolerance / 2 + 0x1p-45 * outline.length;
    // A spike may leave the plane, and the rest of the outline may be flat.
    cut_spikes(loop, spike, check);
    const Vec3 normal = normalized(measure_outline(loop, check).twice_area);
    if (normal == Vec3{}) return {};
    // The triangles of a bent polygon may face many directions, but their sum is its area vector.
    const bool is_bent = !is_flat(loop, normal, reach, check);
    if (is_area_equal && is_bent) return {};
    const Vec3 origin = loop[0];
    for (Vec3& p : loop) {
      check();
      p = p - dot(p - origin, normal) * normal;
    }
    const std::size_t corners = loop.size();
    cut_spikes(loop, spike, check);
    // A part that stands upright on the plane looks like a spike there. If only a corner connects it with the rest, it
    // may have been turned over alone.
    if (is_bent && loop.size() != corners) return {};
    return Outline{std::move(loop), normal, reach};
  }

  const Claim& claim_;
  const NumberedClaim& numbered_;
  RunControl& control_;
  double moved_;  ///< max distance of a corner from its place in the file
};

}  // namespace

void check_polygons(const Claim& claim, const NumberedClaim& numbered, FoundFaults& faults, RunControl& control,
                    std::uint64_t max_pairs) {
  // A mesh of triangles has no polygons to check.
  if (claim.input == nullptr || claim.input->corners.size() == 3 * claim.input->face_count()) return;
  PolygonCheck(claim, numbered, control).run(max_pairs, faults);
}

}  // namespace remesh::verification
