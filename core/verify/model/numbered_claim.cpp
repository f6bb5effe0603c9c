#include "core/verify/model/numbered_claim.h"

#include <array>
#include <atomic>
#include <bit>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"
#include "core/mesh/triangle_corners.h"

namespace remesh::verification {
namespace {

bool is_same_bits(const Vec3& a, const Vec3& b) {
  using Bits = std::array<std::uint64_t, 3>;
  return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b);
}

/// Returns 1 over the power of two above the largest coordinate.
double scale_of(std::span<const Vec3> positions, RunControl& control) {
  const double m = largest_coordinate(positions, control);
  return m > 0 ? std::ldexp(1.0, -std::clamp(std::ilogb(m) + 1, -1000, 1000)) : 1.0;
}

/// The correspondence of output vertices to surface vertices.
struct Matches {
  std::vector<VertexId> of_surface;     ///< the surface vertex with the same bits; invalid if there is none
  std::vector<std::uint8_t> is_single;  ///< the vertex is finite, and no other output vertex is at its place
};

/// Matches output vertices with surface vertices. The output is sorted and searched instead of the surface, because
/// without refinement it is the smaller one, often by far.
Matches match_vertices(const Claim& claim, RunControl& control) {
  const std::span<const Vec3> surface = claim.surface.positions.items();
  struct Place {
    Vec3 position;
    std::uint32_t vertex;
  };
  std::vector<Place> places;
  places.reserve(claim.positions.size());
  StopCheck check(control);
  for (std::size_t v = 0; v < claim.positions.size(); ++v) {
    check();
    if (is_finite(claim.positions[v])) places.push_back({claim.positions[v], static_cast<std::uint32_t>(v)});
  }
  sort_stoppable(places.begin(), places.end(), control, [](const Place& a, const Place& b) {
    return a.position != b.position ? a.position < b.position : a.vertex < b.vertex;
  });
  Matches match;
  match.is_single.assign(claim.positions.size(), 0);
  for (std::size_t i = 0; i < places.size(); ++i) {
    check();
    const bool is_repeated = (i > 0 && places[i - 1].position == places[i].position) ||
                             (i + 1 < places.size() && places[i + 1].position == places[i].position);
    match.is_single[places[i].vertex] = is_repeated ? 0 : 1;
  }
  match.of_surface.resize(claim.positions.size());
  for_blocks(surface.size(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const auto found = std::partition_point(places.begin(), places.end(),
                                              [&](const Place& place) { return place.position < surface[v]; });
      // Surface positions are pairwise different, so no two threads find the same output vertex.
      if (found != places.end() && is_same_bits(found->position, surface[v]))
        match.of_surface[found->vertex] = VertexId(v);
    }
  });
  return match;
}

/// Checks that each listed face has one reason, that the faces ascend, and that the goals are numbers.
/// Numbers the output's faces by the model's vertices, and marks the vertices that they use.
void renumber_output(const Claim& claim, const std::vector<VertexId>& match, NumberedClaim& numbered,
                     FoundFaults& faults, RunControl& control) {
  const std::size_t face_count = claim.faces.size();
  numbered.is_in_output.assign(numbered.points.size(), 0);
  numbered.output_face_begin = triangle_begins(face_count, control);
  numbered.output_corners.resize(3 * face_count);
  const auto blocks =
      map_blocks<std::vector<FoundFault>>(face_count, kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
        std::vector<FoundFault> moved;
        for (std::size_t f = begin; f < end; ++f)
          for (std::size_t i = 0; i < 3; ++i) {
            const VertexId v = claim.faces[f][i], matched = match[v.value];
            if (matched.value >= numbered.new_vertex_end)
              moved.push_back({claim.face_patch[f], Fault::kMovedVertex, v.value});
            std::atomic_ref(numbered.is_in_output[matched.value]).store(1, std::memory_order_relaxed);
            numbered.output_corners[3 * f + i] = matched;
          }
        return moved;
      });
  for (const auto& moved : blocks) faults.add(moved);
}

/// Takes over vertices that are claimed to be moved. A claim is not believed if the vertex is not on a curved patch, or
/// if the output still has a vertex at its old place; then the output vertex is matched with nothing.
void take_moved(const Claim& claim, const std::vector<std::uint8_t>& is_single, std::vector<VertexId>& match,
                NumberedClaim& numbered, RunControl& control) {
  if (claim.moved.empty() || !numbered.has_curved()) return;
  const Surface& surface = claim.surface;
  std::vector<double> allowed(surface.vertex_count(), -1);
  StopCheck check(control);
  for (std::size_t f = 0; f < surface.face_count(); ++f) {
    const CurvedSurface* const curved = numbered.curved_surface(claim.surface_patch[f]);
    if (curved == nullptr) continue;
    for (const VertexId v : surface.face(FaceId(f))) {
      check();
      allowed[v.value] = std::max(allowed[v.value], curved->tolerance + numbered.tolerance);
    }
  }
  std::vector<std::uint8_t> is_taken(surface.vertex_count(), 0);
  for (const VertexId v : match)
    if (v.is_valid()) is_taken[v.value] = 1;
  numbered.points.moved.at.assign(surface.vertex_count(), kNone);
  for (const auto& [output, v] : claim.moved) {
    check();
    const bool is_possible = !match[output.value].is_valid() && is_single[output.value] != 0 &&
                             is_taken[v.value] == 0 && allowed[v.value] >= 0;
    if (!is_possible) continue;
    is_taken[v.value] = 1;
    match[output.value] = v;
    numbered.points.moved.at[v.value] = static_cast<std::uint32_t>(numbered.points.moved.to.size());
    numbered.points.moved.to.push_back(numbered.scale * claim.positions[output.value]);
    numbered.points.moved.allowed.push_back(allowed[v.value]);
  }
}

/// Returns the unit normal of a triangle; null if it has no area.
Vec3 normal_of(const Points& points, std::span<const VertexId> face) {
  const Vec3 a = points[face[0].value];
  const Vec3 twice_area = cross(points[face[1].value] - a, points[face[2].value] - a);
  const double length = norm(twice_area);
  return length > 0 ? (1 / length) * twice_area : Vec3{};
}

Grouping by_patch(const Faces& faces, std::size_t patch_count, RunControl& control) {
  return group_by(
      faces.count(), patch_count, [&](std::uint32_t f) { return faces.patch[f].value; }, control);
}

/// Returns which patches are one triangle of the input and the same triangle in the output.
std::vector<std::uint8_t> find_kept(const NumberedClaim& numbered, RunControl& control) {
  std::vector<std::uint8_t> is_kept(numbered.patch_count(), 0);
  for_blocks(is_kept.size(), kItemsPerBlock, control, [&](std::size_t p, std::size_t end) {
    for (; p < end; ++p) {
      const auto before = numbered.input_by_patch[p], after = numbered.output_by_patch[p];
      if (before.size() != 1 || after.size() != 1 || numbered.curved_surface(PatchId(p)) != nullptr) continue;
      const auto input = numbered.input.face(before[0]), output = numbered.output.face(after[0]);
      const auto first = std::find(input.begin(), input.end(), output[0]);
      if (input.size() != 3 || first == input.end()) continue;
      const std::size_t at = static_cast<std::size_t>(first - input.begin());
      is_kept[p] = input[(at + 1) % 3] == output[1] && input[(at + 2) % 3] == output[2] &&
                   std::none_of(input.begin(), input.end(), [&](VertexId v) { return numbered.is_moved(v); });
    }
  });
  return is_kept;
}

}  // namespace

Vec3 NumberedClaim::normal(PatchId p) const {
  return is_kept[p.value] != 0 ? normal_of(points, input.face(input_by_patch[p.value][0]))
                               : frames.claimed(p.value).normal;
}

bool is_well_formed(const RefinementClaim& refinement, std::size_t face_count, std::size_t patch_count) {
  const auto& [goals, unrefined, reasons, frozen] = refinement;
  const auto is_bound = [](double bound) { return bound >= 0; };
  return unrefined.size() == reasons.size() &&
         std::adjacent_find(unrefined.begin(), unrefined.end(), std::greater_equal<>()) == unrefined.end() &&
         (unrefined.empty() || unrefined.back().value < face_count) && is_bound(goals.min_angle_deg) &&
         is_bound(goals.max_edge_length) && is_bound(goals.max_area) && is_bound(goals.min_edge_length) &&
         is_bound(goals.proximity) && is_bound(goals.min_gap) && is_bound(goals.gradation) &&
         (frozen.empty() || frozen.size() == patch_count);
}

bool is_well_formed(const Claim& claim, RunControl& control) {
  const Surface& surface = claim.surface;
  const std::size_t patch_count = claim.frames.patch_count();
  const auto is_surface = [&](std::uint32_t s) { return s == kNone || s < claim.curved.size(); };
  if (!claim.curved_of_patch.empty() &&
      (claim.curved_of_patch.size() != patch_count ||
       !std::all_of(claim.curved_of_patch.begin(), claim.curved_of_patch.end(), is_surface)))
    return false;
  if (surface.face_begin.empty() || surface.face_begin[0] != 0 ||
      surface.face_begin.items().back() != surface.corners.size() ||
      claim.surface_patch.size() != surface.face_count() || claim.face_patch.size() != claim.faces.size() ||
      claim.corner_uv.size() != 3 * claim.faces.size())
    return false;
  const auto is_move = [&](const MovedVertex& moved) {
    return moved.output.value < claim.positions.size() && moved.of_surface.value < surface.vertex_count();
  };
  if (!std::all_of(claim.moved.begin(), claim.moved.end(), is_move)) return false;
  if (claim.refinement != nullptr && !is_well_formed(*claim.refinement, claim.faces.size(), patch_count)) return false;
  std::atomic<bool> is_good{true};
  const auto test = [&](std::size_t n, const auto& is_item_good) {
    for_blocks(n, kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
      bool is_block_good = true;
      for (std::size_t i = begin; i < end; ++i) is_block_good &= is_item_good(i);
      if (!is_block_good) is_good.store(false, std::memory_order_relaxed);
    });
  };
  test(surface.positions.size(), [&](std::size_t v) { return is_finite(surface.positions[VertexId(v)]); });
  const std::span<const VertexId> corners = surface.corners;
  const std::size_t vertex_count = surface.vertex_count();
  test(corners.size(), [=](std::size_t h) { return corners[h].value < vertex_count; });
  test(surface.face_count(), [&](std::size_t f) {
    return surface.face_begin[f] + 3 <= surface.face_begin[f + 1] && claim.surface_patch[f].value < patch_count;
  });
  test(claim.faces.size(), [&](std::size_t f) {
    return claim.face_patch[f].value < patch_count &&
           std::all_of(claim.faces[f].begin(), claim.faces[f].end(),
                       [&](VertexId v) { return v.value < claim.positions.size(); });
  });
  return is_good;
}

NumberedClaim number_claim(const Claim& claim, FoundFaults& faults, RunControl& control) {
  NumberedClaim numbered;
  const std::span<const Vec3> surface = claim.surface.positions.items();
  const double scale = scale_of(surface, control);
  numbered.scale = scale;
  numbered.surface_vertex_count = surface.size();
  numbered.points = Points(surface, scale);
  numbered.tolerance = scale * claim.plane_tolerance;
  numbered.frames = Frames(claim.frames, scale);
  if (!claim.curved.empty()) numbered.curved.of_patch = claim.curved_of_patch;
  for (const CurvedClaim& curved : claim.curved)
    numbered.curved.surfaces.push_back({CurvedShape(curved.shape, scale), scale * curved.tolerance, curved});

  const Matches matches = match_vertices(claim, control);
  std::vector<VertexId> match = matches.of_surface;
  const auto append = [&](std::size_t v) {
    match[v] = VertexId(numbered.points.size());
    numbered.points.push_back(claim.positions[v]);
  };
  take_moved(claim, matches.is_single, match, numbered, control);
  StopCheck check(control);
  for (std::size_t v = 0; v < match.size(); ++v) {
    check();
    if (claim.has_new_vertices && !match[v].is_valid() && matches.is_single[v] && is_finite(scale * claim.positions[v]))
      append(v);
  }
  numbered.new_vertex_end = numbered.points.size();
  for (std::size_t v = 0; v < match.size(); ++v) {
    check();
    if (match[v].is_valid()) continue;
    faults.add(PatchId(), Fault::kMovedVertex, static_cast<std::uint32_t>(v));
    append(v);
  }

  renumber_output(claim, match, numbered, faults, control);
  numbered.input = {claim.surface.face_begin, claim.surface.corners, claim.surface_patch};
  numbered.output = {numbered.output_face_begin, numbered.output_corners, claim.face_patch};
  numbered.corner_uv = claim.corner_uv;
  numbered.input_by_patch = by_patch(numbered.input, numbered.patch_count(), control);
  numbered.output_by_patch = by_patch(numbered.output, numbered.patch_count(), control);
  numbered.is_kept = find_kept(numbered, control);
  // The tests of goals need all bounding edges.
  if (claim.refinement == nullptr) numbered.input.is_kept = numbered.output.is_kept = numbered.is_kept;
  return numbered;
}

}  // namespace remesh::verification
