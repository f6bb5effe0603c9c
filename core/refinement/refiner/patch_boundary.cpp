#include "core/refinement/refiner/patch_boundary.h"

#include <cmath>
#include <numeric>
#include <tuple>

#include "core/base/small_blocks.h"

namespace remesh {
namespace {

/// Two distances along segments belong to the same ring if they differ by no more than this fraction.
constexpr double kSameRing = 1e-9;

/// Returns whether two vertices are equally far from the corner between them, and nearer to each other than to it.
bool is_on_one_ring(double from_a, double from_b, double distance) {
  return std::fabs(from_a - from_b) <= kSameRing * from_a && distance < from_a * (1 - kSameRing);
}

}  // namespace

UnrefinedReason why_locked(Lock lock) {
  switch (lock) {
    case Lock::kFixed: return UnrefinedReason::kBoundaryLocked;
    case Lock::kAsked: return UnrefinedReason::kMinEdgeLength;
    case Lock::kNoRoom:
    case Lock::kNone: break;
  }
  return UnrefinedReason::kSizeFloor;
}

UnrefinedReason why_near(MinSpacing spacing) {
  return spacing.is_asked ? UnrefinedReason::kMinEdgeLength : UnrefinedReason::kSizeFloor;
}

UnrefinedReason stronger(UnrefinedReason a, UnrefinedReason b) {
  const auto rank = [](UnrefinedReason why) {
    return why == UnrefinedReason::kBoundaryLocked ? 2 : why == UnrefinedReason::kSizeFloor ? 1 : 0;
  };
  return rank(b) > rank(a) ? b : a;
}

PatchBoundary::PatchBoundary(const PatchToRefine& patch, std::pmr::memory_resource* memory)
    : segments_(patch.segments), sides_(memory), chains_(memory), corner_segments_(memory), corner_begin_(memory) {
  collect_corner_segments(patch);
  collect_sides(patch);
}

std::size_t PatchBoundary::usual_bytes(std::size_t corners, std::size_t sides) {
  // The number of sides may double. Everything else keeps its size.
  return 2 * sides * sizeof(Side) + corners * sizeof(std::uint32_t) +
         sides * (2 * sizeof(CornerSegment) + sizeof(Chain));
}

void PatchBoundary::collect_corner_segments(const PatchToRefine& patch) {
  const PatchMesh& mesh = patch.mesh;
  const auto for_each_end = [&](const auto& visit) {
    for (const std::uint32_t i : segments_.sides_of_patch(patch.id)) {
      const SegmentSide& side = segments_.all_sides()[i];
      const std::uint32_t a = mesh.mesh.from(side.half_edge), b = mesh.mesh.to(side.half_edge);
      visit(a, b, side.segment);
      visit(b, a, side.segment);
    }
  };
  // First, the segments at each corner are counted. Few segments meet at one corner.
  const std::size_t n = mesh.vertices.size();
  corner_begin_.assign(n + 1, 0);
  for_each_end([&](std::uint32_t corner, std::uint32_t, SegmentId) { ++corner_begin_[corner + 1]; });
  std::partial_sum(corner_begin_.begin(), corner_begin_.end(), corner_begin_.begin());
  corner_segments_.resize(corner_begin_[n]);
  StackMemory memory;
  std::pmr::vector<std::uint32_t> at(corner_begin_.begin(), corner_begin_.end() - 1, &memory);
  for_each_end([&](std::uint32_t corner, std::uint32_t other, SegmentId s) {
    corner_segments_[at[corner]++] = {mesh.vertices[other], s};
  });
  for (std::size_t v = 0; v < n; ++v)
    std::sort(corner_segments_.begin() + corner_begin_[v], corner_segments_.begin() + corner_begin_[v + 1],
              [](const CornerSegment& a, const CornerSegment& b) {
                return std::tie(a.other, a.segment) < std::tie(b.other, b.segment);
              });
}

void PatchBoundary::collect_sides(const PatchToRefine& patch) {
  const auto own = segments_.sides_of_patch(patch.id);
  sides_.reserve(2 * own.size());
  chains_.reserve(own.size());
  for (const std::uint32_t i : own) {
    const SegmentSide& side = segments_.all_sides()[i];
    const std::uint32_t index = side_count();
    const bool is_second = !chains_.empty() && chains_.back().segment == side.segment;
    if (is_second)
      sides_.back().partner = index;
    else
      chains_.push_back({side.segment, index});
    const bool is_forward = patch.mesh.vertices[patch.mesh.mesh.from(side.half_edge)] == segments_[side.segment].from;
    sides_.push_back(
        {0, 1, kNone, static_cast<std::uint32_t>(chains_.size() - 1), is_second ? index - 1 : kNone, is_forward});
  }
}

void PatchBoundary::list_pieces(SegmentId segment, std::vector<std::uint32_t>& pieces) const {
  const auto chain = std::lower_bound(chains_.begin(), chains_.end(), segment,
                                      [](const Chain& c, SegmentId s) { return c.segment < s; });
  pieces.clear();
  for (std::uint32_t s = chain->first; s != kNone; s = sides_[s].next) pieces.push_back(s);
  std::sort(pieces.begin(), pieces.end(),
            [&](std::uint32_t a, std::uint32_t b) { return sides_[a].t0 < sides_[b].t0; });
}

void PatchBoundary::split(std::uint32_t s, double t) {
  Side& first = sides_[s];
  Side second = first;
  (first.is_forward ? first.t1 : first.t0) = t;
  (first.is_forward ? second.t0 : second.t1) = t;
  sides_.push_back(second);
}

void PatchBoundary::pair_pieces(std::uint32_t first, std::uint32_t second) {
  const std::uint32_t of_first = side_count() - 2, of_second = side_count() - 1;
  sides_[first].partner = of_second;
  sides_[of_second].partner = first;
  sides_[of_first].partner = second;
  sides_[second].partner = of_first;
}

std::uint32_t PatchBoundary::divide(std::uint32_t s, std::span<const double> cuts) {
  const Side whole = sides_[s];
  const std::uint32_t first_new = side_count();
  const auto n = static_cast<std::uint32_t>(cuts.size());
  const bool is_second = whole.partner != kNone && whole.partner < s;
  for (std::uint32_t k = 0; k <= n; ++k) {
    // The piece between the k-th vertex along the segment and the next one.
    const std::uint32_t index = k == 0 ? s : first_new + k - 1;
    if (k > 0) {
      sides_.push_back(whole);
      sides_[index].partner = kNone;
      if (is_second) {
        sides_[index].partner = index - n;
        sides_[index - n].partner = index;
      } else {
        add_to_chain(index);
      }
    }
    sides_[index].t0 = k == 0 ? 0 : cuts[k - 1];
    sides_[index].t1 = k == n ? 1 : cuts[k];
  }
  return first_new;
}

UnrefinedReason PatchBoundary::why_uncut(std::span<const std::uint32_t> sides, UnrefinedReason otherwise) const {
  std::optional<UnrefinedReason> why;
  for (const std::uint32_t s : sides) {
    const Lock lock = segments_[segment_of(s)].lock;
    if (lock != Lock::kNone) why = why ? stronger(*why, why_locked(lock)) : why_locked(lock);
  }
  return why.value_or(otherwise);
}

bool PatchBoundary::is_across_input_angle(const Vertex& a, const Vertex& b, double distance) const {
  const bool a_is_cut = a.place.is_on_segment(), b_is_cut = b.place.is_on_segment();
  if (a_is_cut && b_is_cut) return is_across(a.place, b.place, distance);
  if (a_is_cut) return is_across(a.place, b.number, distance);
  if (b_is_cut) return is_across(b.place, a.number, distance);
  return is_across(a.number, b.number, distance);
}

/// Returns the distance from a vertex on a segment to one end of the segment: 0 is the first one, 1 the last one.
double PatchBoundary::distance_to_end(const VertexPlace& place, int end) const {
  const double t = place.parameter();
  return (end == 0 ? t : 1 - t) * segments_[place.segment()].length;
}

/// Looks for a corner where the segments of two cuts meet.
bool PatchBoundary::is_across(const VertexPlace& a, const VertexPlace& b, double distance) const {
  if (a.segment() == b.segment()) return false;
  const BoundarySegment &s = segments_[a.segment()], &u = segments_[b.segment()];
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j)
      if ((i == 0 ? s.from : s.to) == (j == 0 ? u.from : u.to) &&
          is_on_one_ring(distance_to_end(a, i), distance_to_end(b, j), distance))
        return true;
  return false;
}

/// Looks for a segment from the corner to an end of the segment of a cut.
bool PatchBoundary::is_across(const VertexPlace& cut, std::uint32_t corner, double distance) const {
  const BoundarySegment& s = segments_[cut.segment()];
  for (int i = 0; i < 2; ++i) {
    const CornerSegment* found = find_other(segments_at(corner), i == 0 ? s.from : s.to);
    if (found != nullptr && found->segment != cut.segment() &&
        is_on_one_ring(distance_to_end(cut, i), segments_[found->segment].length, distance))
      return true;
  }
  return false;
}

/// Looks for a third corner to which two corners have segments.
bool PatchBoundary::is_across(std::uint32_t a, std::uint32_t b, double distance) const {
  std::span<const CornerSegment> few = segments_at(a), many = segments_at(b);
  if (few.size() > many.size()) std::swap(few, many);
  return std::any_of(few.begin(), few.end(), [&](const CornerSegment& s) {
    const CornerSegment* found = find_other(many, s.other);
    return found != nullptr && is_on_one_ring(segments_[s.segment].length, segments_[found->segment].length, distance);
  });
}

/// Searches the segments that meet at one corner for those that end at the corner `other`. Returns the first of them in
/// the order of the list, or null if there is none.
const PatchBoundary::CornerSegment* PatchBoundary::find_other(std::span<const CornerSegment> at_corner,
                                                              VertexId other) {
  const auto found = std::lower_bound(at_corner.begin(), at_corner.end(), other,
                                      [](const CornerSegment& c, VertexId v) { return c.other < v; });
  return found != at_corner.end() && found->other == other ? &*found : nullptr;
}

}  // namespace remesh
