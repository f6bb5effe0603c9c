#include "core/verify/verify.h"

#include <algorithm>
#include <atomic>
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/run_control.h"
#include "core/base/stoppable.h"
#include "core/geometry/exact/predicates_3d.h"
#include "core/geometry/intersections/patch_intersections.h"
#include "core/geometry/trees/triangle_tree.h"
#include "core/geometry/triangles/triangle_intersection.h"
#include "core/mesh/triangle_corners.h"
#include "core/verify/boundary/boundary.h"
#include "core/verify/claim/claim.h"
#include "core/verify/claim/verification_faults.h"
#include "core/verify/goals/goal_check.h"
#include "core/verify/goals/varying_sizes.h"
#include "core/verify/model/edge_table.h"
#include "core/verify/model/face_measures.h"
#include "core/verify/model/fixed_width_integers.h"
#include "core/verify/model/numbered_claim.h"
#include "core/verify/patches/patch_shape.h"
#include "core/verify/polygons/caps.h"
#include "core/verify/polygons/polygon_cover_check.h"

namespace remesh {
namespace {

using namespace verification;

/// Finds the output faces that are no triangles of the input, and the faces near these, unless it is seen at once that
/// none of them intersects another face. Two triangles of the input meet in the output where they meet in the input, so
/// a new intersection has one of the changed faces.
/// Output: ascending numbers: the changed faces, and the faces whose boxes meet the box of a changed face.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n log n).
std::vector<std::uint32_t> faces_near_changes(const Claim& claim, const NumberedClaim& numbered,
                                              const EdgeTable& input_edges, RunControl& control) {
  const std::size_t n = claim.faces.size();
  const std::vector<std::uint32_t> changed = select_ids<std::uint32_t>(n, kItemsPerBlock, control, [&](std::size_t f) {
    return numbered.is_kept[claim.face_patch[f].value] == 0 &&
           !is_input_triangle(numbered, input_edges, claim.face_patch[f], numbered.output.face(f));
  });
  if (changed.empty()) return {};
  // A tree would exclude few faces.
  constexpr std::size_t kMany = 2;
  if (kMany * changed.size() >= n) {
    std::vector<std::uint32_t> all(n);
    std::iota(all.begin(), all.end(), 0U);
    return all;
  }
  std::vector<Triangle> triangles;
  triangles.reserve(changed.size());
  for (const std::uint32_t f : changed) triangles.push_back(claim.faces[f]);
  const std::vector<Vec3> positions = scaled_for_predicates(claim.positions, control);
  const TriangleTree tree(positions, triangles, control);
  // A face of a scan has some ten changed faces near it. Where there are many more, the search that comes next knows
  // how to get along with them.
  constexpr std::size_t kFewNear = 64;
  std::atomic<bool> are_apart = true;
  std::vector<std::uint32_t> near = select_ids<std::uint32_t>(n, kItemsPerBlock, control, [&](std::size_t f) {
    Box3 box;
    for (const VertexId v : claim.faces[f]) box.add(positions[v.value]);
    std::size_t looks = 0;
    tree.visit_meeting(box, 0, [&](std::size_t slot) {
      ++looks;
      if (!are_apart.load(std::memory_order_relaxed)) return false;
      const std::uint32_t g = changed[tree.face(slot).value];
      if (looks > kFewNear || (f != g && do_intersect(claim.faces[f], claim.faces[g], positions)))
        are_apart.store(false, std::memory_order_relaxed);
      return true;
    });
    return looks > 0;
  });
  if (are_apart) near.clear();
  return near;
}

/// Tests the edges inside patches on the stored plane coordinates.
class DelaunayCheck {
 public:
  DelaunayCheck(const NumberedClaim& numbered, const EdgeTable& edges, const std::vector<std::uint8_t>& is_positive)
      : numbered_(numbered), edges_(edges), is_positive_(is_positive) {}

  void run(FoundFaults& faults, RunControl& control) const {
    const auto blocks = map_blocks<std::vector<FoundFault>>(edges_.vertex_count(), kItemsPerBlock, control,
                                                            [&](std::size_t begin, std::size_t end) {
                                                              std::vector<FoundFault> found;
                                                              edges_.for_each_edge(begin, end, [&](const Edge& edge) {
                                                                if (edge.is_interior()) check(edge, found);
                                                              });
                                                              return found;
                                                            });
    for (const auto& found : blocks) faults.add(found);
  }

 private:
  /// One triangle at an edge, by its corners. The edge runs from `from` to `to`.
  struct Side {
    std::uint32_t face, from, to, apex;
    explicit Side(std::uint32_t half_edge)
        : face(half_edge / 3),
          from(half_edge),
          to(3 * face + (half_edge + 1) % 3),
          apex(3 * face + (half_edge + 2) % 3) {}
  };

  void check(const Edge& edge, std::vector<FoundFault>& found) const {
    const Side left(edge.uses[0].half_edge), right(edge.uses[1].half_edge);
    // Triangles without sound coordinates have been reported, or are triangles of the input and exempt.
    if (!is_positive_[left.face] || !is_positive_[right.face]) return;
    const PatchId patch = edge.uses[0].patch();
    const auto& uv = numbered_.corner_uv;
    if (uv[left.from] != uv[right.to] || uv[left.to] != uv[right.from]) {
      found.push_back({patch, Fault::kPlaneCoordinates, left.face});
      return;
    }
    const double grid = numbered_.frames.claimed(patch.value).grid;
    if (!is_inside_circle(uv[left.from], uv[left.to], uv[left.apex], uv[right.apex], grid)) return;
    // The chord rule: a flip must not make an edge that exists already, in this patch or another.
    const auto& corners = numbered_.output.corners;
    if (edges_.find(corners[left.apex], corners[right.apex]).empty())
      found.push_back({patch, Fault::kNotDelaunay, left.face});
  }

  const NumberedClaim& numbered_;
  const EdgeTable& edges_;
  const std::vector<std::uint8_t>& is_positive_;
};

/// Counts the indices of 0 .. n-1 for which is_set(i) is true.
template <class IsSet>
std::int64_t count_set(std::size_t n, RunControl& control, const IsSet& is_set) {
  const auto counts = map_blocks<std::int64_t>(n, kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
    std::int64_t count = 0;
    for (std::size_t i = begin; i < end; ++i) count += is_set(i);
    return count;
  });
  return std::accumulate(counts.begin(), counts.end(), std::int64_t{0});
}

void check_whole(const NumberedClaim& numbered, const EdgeCounts& input, std::int64_t input_vertices,
                 const EdgeCounts& output, const ShapeSums& shapes, FoundFaults& faults, RunControl& control) {
  const auto euler = [](std::int64_t vertices, const Faces& faces, const EdgeCounts& counts) {
    return vertices - static_cast<std::int64_t>(counts.edges) + static_cast<std::int64_t>(faces.count());
  };
  const std::int64_t output_vertices =
      count_set(numbered.is_in_output.size(), control, [&](std::size_t v) { return numbered.is_in_output[v] != 0; });
  if (euler(input_vertices, numbered.input, input) != euler(output_vertices, numbered.output, output))
    faults.add(PatchId(), Fault::kEuler);
  if (input.is_closed && !output.is_closed) faults.add(PatchId(), Fault::kOpened);
  if (input.is_closed && input.is_consistent && !(std::fabs(shapes.volume_change) <= shapes.volume_bound))
    faults.add(PatchId(), Fault::kVolume);
}

/// After this number of pairs that the input does not have, the search ends.
constexpr std::size_t kMinUnexpected = 1 << 12, kUnexpectedPerPatch = 8;

/// Returns a unit vector for each patch. The frame of a curved patch has not been tested, and a triangle without area
/// has no normal. Any direction will do for such a patch.
std::vector<Vec3> unit_normals(const NumberedClaim& numbered, RunControl& control) {
  std::vector<Vec3> normals(numbered.patch_count());
  for_blocks(normals.size(), kItemsPerBlock, control, [&](std::size_t p, std::size_t end) {
    for (; p < end; ++p) {
      const Vec3 normal = numbered.normal(PatchId(p));
      normals[p] = std::fabs(norm(normal) - 1) <= 1e-12 ? normal : Vec3{0, 0, 1};
    }
  });
  return normals;
}

/// Finds the pairs among some output faces that intersect. No pair is expected.
/// Input: ascending numbers of faces.
SelfIntersections find_near_changes(const Claim& claim, const NumberedClaim& numbered,
                                    std::span<const std::uint32_t> faces, std::span<const std::uint8_t> is_simple,
                                    const SearchLimits& limits, RunControl& control) {
  if (faces.empty()) return {};
  const std::vector<Vec3> normals = unit_normals(numbered, control);
  if (faces.size() == claim.faces.size())
    return patch_intersections({claim.positions, corners_of(claim.faces), claim.face_patch, normals, is_simple}, limits,
                               control);
  std::vector<Triangle> triangles;
  std::vector<PatchId> patch;
  StopCheck check(control);
  for (const std::uint32_t f : faces) {
    check();
    triangles.push_back(claim.faces[f]);
    patch.push_back(claim.face_patch[f]);
  }
  SelfIntersections found =
      patch_intersections({claim.positions, corners_of(triangles), patch, normals, is_simple}, limits, control);
  for (auto& [f, g] : found.pairs) {
    check();
    f = FaceId(faces[f.value]);
    g = FaceId(faces[g.value]);
  }
  return found;
}

/// Writes the pairs of output faces that intersect to the verdict.
void check_intersections(const Claim& claim, const NumberedClaim& numbered, const EdgeTable& input_edges,
                         const std::vector<std::uint8_t>& is_positive, FoundFaults& faults, Verdict& verdict,
                         RunControl& control) {
  // A face with a vertex that is not finite intersects nothing, and such a result has failed already.
  if (!std::all_of(claim.positions.begin(), claim.positions.end(), [](const Vec3& p) { return is_finite(p); })) return;
  // In its plane, a patch of positive triangles covers no point twice unless its boundary does.
  std::vector<std::uint8_t> is_simple(numbered.patch_count(), 1);
  StopCheck check(control);
  for (std::size_t f = 0; f < claim.faces.size(); ++f) {
    check();
    if (!is_positive[f]) is_simple[claim.face_patch[f].value] = 0;
  }
  static const InputIntersections kNoIntersections;
  const InputIntersections& known = claim.intersections != nullptr ? *claim.intersections : kNoIntersections;
  // If the input's intersections are not all known, those of the output prove nothing. Then a few are enough to show
  // where they are. Otherwise the search continues, however long it takes.
  SearchLimits limits(SearchLimits::kEnoughPairs);
  if (!known.is_complete) {
    limits.max_steps = SearchLimits::few_steps_for(claim.faces.size());
  } else {
    limits.is_expected = [&](FaceId f, FaceId g) {
      return known.has(claim.face_patch[f.value], claim.face_patch[g.value]);
    };
    // A single one of these pairs makes the result fail. This number of pairs shows nearly all patches that have any.
    limits.max_unexpected = kMinUnexpected + kUnexpectedPerPatch * numbered.patch_count();
    const std::uint64_t few = SearchLimits::few_steps_for(claim.faces.size());
    (faults.is_any() ? limits.max_steps : limits.max_steps_with_unexpected) = few;
  }
  // A result that has failed already needs no list of intersections that prove nothing.
  if (!known.is_complete && (faults.is_any() || !known.are_told)) {
    verdict.are_all_intersections_known = false;
    return;
  }
  SelfIntersections found;
  if (known.is_complete && known.patches.empty())
    found = find_near_changes(claim, numbered, faces_near_changes(claim, numbered, input_edges, control), is_simple,
                              limits, control);
  else
    found = patch_intersections(
        {claim.positions, corners_of(claim.faces), claim.face_patch, unit_normals(numbered, control), is_simple},
        limits, control);
  if (known.is_complete)
    for (const auto& [f, g] : found.pairs) {
      check();
      const PatchId p = claim.face_patch[f.value], q = claim.face_patch[g.value];
      if (known.has(p, q)) continue;
      faults.add(p, Fault::kNewIntersection, f.value);
      faults.add(q, Fault::kNewIntersection, g.value);
    }
  verdict.are_all_intersections_known = known.is_complete && found.is_complete;
  verdict.intersections = std::move(found.pairs);
  verdict.are_all_intersections_listed = found.are_all_listed;
  verdict.searched = found.searched;
  verdict.search_steps = found.steps;
}

}  // namespace

class Verification::Tests {
 public:
  Tests(const Claim& claim, RunControl& control)
      : claim_(claim), control_(control), faults_(claim.frames.patch_count(), claim.refinement != nullptr) {
    is_well_formed_ = is_well_formed(claim, control);
    if (is_well_formed_)
      test_surface();
    else
      faults_.add(PatchId(), Fault::kMalformed);
  }

  bool has_failed() const { return faults_.is_any(); }

  Verdict finish() {
    // Checking sizes that vary takes as long as all other tests. A result that has failed already is not checked for
    // them.
    const Goals* const goals = claim_.refinement != nullptr ? &claim_.refinement->goals : nullptr;
    const bool do_sizes_vary = goals != nullptr && (goals->proximity > 0 || goals->gradation > 0);
    const bool are_goals_checked = is_well_formed_ && goals != nullptr && !(do_sizes_vary && has_failed());
    if (are_goals_checked) test_goals(do_sizes_vary);
    faults_.write_to(verdict_);
    if (is_well_formed_ && goals != nullptr && !are_goals_checked) verdict_.quality = false;
    if (is_well_formed_) control_.progress(1);
    return std::move(verdict_);
  }

 private:
  void test_surface() {
    // Output vertices get the surface's vertex numbers by exact coordinates.
    numbered_.emplace(number_claim(claim_, faults_, control_));
    const NumberedClaim& numbered = *numbered_;
    control_.progress(0.1);

    // Checks the faces that were made of the input's polygons.
    check_polygons(claim_, numbered, faults_, control_);

    // Finds the faces that use each edge, in the input and in the output.
    std::optional<EdgeTable> edges_before;
    std::optional<BoundaryGraph> seams_before, seams_after;
    const auto look_at = [&](const Faces& faces, std::span<const std::uint32_t> order, std::optional<EdgeTable>& edges,
                             std::optional<BoundaryGraph>& seams) {
      edges.emplace(numbered.points.size(), faces, order, control_);
      seams.emplace(numbered.points.size(), edges->take_bounding(), control_);
    };
    // In most cases the input is the larger one. It is read on this thread, whose memory is near all other memory of
    // the run.
    do_all(
        numbered.input.corners.size() + numbered.output.corners.size(),
        [&] { look_at(numbered.output, {}, output_edges_, seams_after); },
        [&] { look_at(numbered.input, claim_.surface_edge_order, edges_before, seams_before); });
    seams_ = Seams{*std::move(seams_before), *std::move(seams_after)};
    check_caps(claim_, numbered, *edges_before, faults_, control_);
    control_.progress(0.2);

    // Checks that loops are preserved and edges conform.
    const Boundary boundary = check_boundary(numbered, *seams_, faults_, control_);
    control_.progress(0.25);

    // Checks that each patch is the same piece of surface and that its triangles are sound.
    std::vector<std::uint8_t> is_positive;
    const ShapeSums shapes =
        check_shapes(numbered, *edges_before, *seams_, boundary, is_positive, verdict_.patch_bounds, faults_, control_);
    verdict_.deviation = shapes.deviation / numbered.scale;
    for (double& bound : verdict_.patch_bounds) bound /= numbered.scale;
    verdict_.distance_bound = {verdict_.deviation, verdict_.deviation};
    // The minimum keeps the bound finite for a model near the largest double, as its volume is.
    verdict_.volume_bound = std::min(std::ldexp(shapes.volume_bound, -3 * std::ilogb(numbered.scale)), DBL_MAX);
    control_.progress(0.3);

    // The search for intersections takes most of the time.
    DelaunayCheck(numbered, *output_edges_, is_positive).run(faults_, control_);
    check_intersections(claim_, numbered, *edges_before, is_positive, faults_, verdict_, control_);
    check_whole(numbered, edges_before->counts(), boundary.input_vertices, output_edges_->counts(), shapes, faults_,
                control_);
  }

  void test_goals(bool do_sizes_vary) {
    const RefinementClaim& refinement = *claim_.refinement;
    if (!is_well_formed(refinement, claim_.faces.size(), claim_.frames.patch_count())) {
      faults_.add(PatchId(), Fault::kMalformed);
      return;
    }
    std::optional<VaryingSizes> sizes;
    if (do_sizes_vary) sizes.emplace(claim_, *numbered_, seams_->input, seams_->output, control_);
    check_goals(refinement, *numbered_, *output_edges_, seams_->output, sizes ? &*sizes : nullptr, faults_, control_);
  }

  const Claim& claim_;
  RunControl& control_;
  FoundFaults faults_;
  Verdict verdict_;
  bool is_well_formed_ = false;
  std::optional<NumberedClaim> numbered_;
  std::optional<EdgeTable> output_edges_;
  std::optional<Seams> seams_;
};

Verification::Verification(const Claim& claim, RunControl& control) : tests_(std::make_unique<Tests>(claim, control)) {}
Verification::~Verification() = default;
bool Verification::has_failed() const { return tests_->has_failed(); }
Verdict Verification::finish() { return tests_->finish(); }

Verdict verify(const Claim& claim, RunControl& control) { return Verification(claim, control).finish(); }

}  // namespace remesh
