#include "core/refinement/rounds/rounds.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/ids.h"
#include "core/base/large_first.h"
#include "core/base/parallel.h"
#include "core/base/run_control.h"
#include "core/base/stoppable.h"
#include "core/patch_types/patch_mesh.h"
#include "core/refinement/goals/face_budget.h"
#include "core/refinement/refiner/patch_refiner.h"
#include "core/refinement/rounds/chords.h"
#include "core/refinement/rounds/extra_work_pool.h"
#include "core/refinement/rounds/patch_backup.h"
#include "core/refinement/rounds/refinement.h"
#include "core/refinement/rounds/refinement_input.h"
#include "core/refinement/segments/segment_cuts.h"
#include "core/refinement/segments/segment_table.h"

namespace remesh {
namespace {

/// The refiners of all patches. A patch without a refiner has not changed.
using PatchRefiners = IdVector<PatchId, std::unique_ptr<PatchRefiner>>;

/// The numbers of patches and of segments in a task. The first is small because a patch may have thousands of
/// triangles.
constexpr std::size_t kPatchesPerTask = 16;
constexpr std::size_t kSegmentsPerTask = 1024;

/// Returns the number of the first new vertex on each segment, and behind the last one the number of all of them.
std::vector<std::uint32_t> first_cut_of_segments(const SegmentTable& segments, const SegmentCuts& cuts,
                                                 RunControl& control) {
  std::vector<std::uint32_t> first(segments.size() + 1, 0);
  StopCheck check(control);
  for (std::size_t s = 0; s < segments.size(); ++s) {
    check();
    first[s + 1] = first[s] + static_cast<std::uint32_t>(cuts[SegmentId(s)].size());
  }
  return first;
}

/// Counts the vertices inside a patch that have no id yet.
std::size_t count_unplaced(const PatchMesh& patch) {
  return static_cast<std::size_t>(
      std::count_if(patch.vertices.begin(), patch.vertices.end(), [](VertexId v) { return !v.is_valid(); }));
}

/// Numbers the vertices inside a patch that have no id yet, from `first` on, and sets their positions.
/// Output: the number of these vertices.
std::size_t place_inner_vertices(const Surface& surface, const PatchChart& chart, PatchMesh& patch, std::size_t first,
                                 std::vector<Vec3>& new_positions) {
  const std::size_t begin = first;
  for (std::size_t v = 0; v < patch.vertices.size(); ++v) {
    if (patch.vertices[v].is_valid()) continue;
    patch.vertices[v] = VertexId(surface.vertex_count() + first);
    new_positions[first++] = chart.new_position(patch.uv[v]);
  }
  return first - begin;
}

/// Makes the patches from the present state of their refiners. New vertices on segments come first, segment after
/// segment, and then those inside patches, patch after patch.
/// Input:  If `are_refiners_kept` is false, each refiner is deleted when its patch is made.
/// Output: The patches that have a refiner, and `new_positions`, `first_inner` and `reason` of the result. A patch
///         without a refiner stays as it was, because it is frozen or has no work.
PatchBackup collect_refined(const RefinementInput& input, const SegmentTable& segments, const SegmentCuts& cuts,
                            const TriangulatedPatches& triangulated, PatchRefiners& refiners, bool are_refiners_kept,
                            Refinement& result, RunControl& control) {
  const std::size_t n = triangulated.size(), old = input.surface.vertex_count();
  const std::vector<std::uint32_t> first_cut = first_cut_of_segments(segments, cuts, control);
  result.first_inner = first_cut.back();
  std::vector<PatchId> ids =
      select_ids<PatchId>(n, kItemsPerBlock, control, [&](std::size_t p) { return refiners[PatchId(p)] != nullptr; });
  FreedInParallel<PatchMesh> all;
  std::vector<PatchMesh>& meshes = all.items;
  meshes.resize(ids.size());
  std::vector<std::vector<UnrefinedReason>> reasons(ids.size());
  // First, these are the counts for each patch that is refined, and for each patch. Then they become the sums over all
  // patches before it.
  std::vector<std::size_t> first_inner(ids.size() + 1, 0), first_triangle(n + 1, 0);
  for_blocks(n, kItemsPerBlock, control, [&](std::size_t p, std::size_t end) {
    for (; p < end; ++p) first_triangle[p + 1] = triangulated.meshes[PatchId(p)].mesh.triangle_count();
  });
  for_blocks(ids.size(), kPatchesPerTask, control, [&](std::size_t i, std::size_t end) {
    for (; i < end; ++i) {
      std::unique_ptr<PatchRefiner>& refiner = refiners[ids[i]];
      PatchRefiner::Refined patch = refiner->finish();
      if (!are_refiners_kept) refiner.reset();
      for (std::size_t v = 0; v < patch.cuts.size(); ++v) {
        const Cut& cut = patch.cuts[v];
        if (!cut.segment.is_valid()) continue;
        const std::vector<double>& of_segment = cuts[cut.segment];
        const auto k = std::lower_bound(of_segment.begin(), of_segment.end(), cut.t) - of_segment.begin();
        patch.patch.vertices[v] = VertexId(old + first_cut[cut.segment.value] + static_cast<std::size_t>(k));
      }
      first_inner[i + 1] = count_unplaced(patch.patch);
      first_triangle[ids[i].value + 1] = patch.patch.mesh.triangle_count();
      reasons[i] = std::move(patch.reason);
      meshes[i] = std::move(patch.patch);
    }
  });
  first_inner[0] = result.first_inner;
  std::partial_sum(first_inner.begin(), first_inner.end(), first_inner.begin());
  std::partial_sum(first_triangle.begin(), first_triangle.end(), first_triangle.begin());
  result.new_positions.resize(first_inner.back());
  result.reason.assign(first_triangle[n], UnrefinedReason::kSizeFloor);
  StopCheck check(control);
  for (std::size_t p = 0; p < n; ++p) {
    check();
    if (input.is_frozen[PatchId(p)] != 0)
      std::fill(result.reason.begin() + static_cast<std::ptrdiff_t>(first_triangle[p]),
                result.reason.begin() + static_cast<std::ptrdiff_t>(first_triangle[p + 1]),
                UnrefinedReason::kBoundaryLocked);
  }
  for_blocks(segments.size(), kSegmentsPerTask, control, [&](std::size_t s, std::size_t end) {
    for (; s < end; ++s) {
      const std::vector<double>& of_segment = cuts[SegmentId(s)];
      for (std::size_t k = 0; k < of_segment.size(); ++k)
        result.new_positions[first_cut[s] + k] = segments.position(SegmentId(s), of_segment[k]);
    }
  });
  for_blocks(ids.size(), kPatchesPerTask, control, [&](std::size_t i, std::size_t end) {
    for (; i < end; ++i) {
      place_inner_vertices(input.surface, triangulated.charts[ids[i]], meshes[i], first_inner[i], result.new_positions);
      std::copy(reasons[i].begin(), reasons[i].end(),
                result.reason.begin() + static_cast<std::ptrdiff_t>(first_triangle[ids[i].value]));
    }
  });
  return {std::move(ids), std::move(meshes)};
}

/// The first kPatientRestarts restarts lock only the segments that had to be cut where rounding left no room. Later
/// ones lock all segments of the patches beside these, and in the end all segments. So there are few restarts.
constexpr int kPatientRestarts = 8, kMaxRestarts = 16;

/// Locks segments before the refinement restarts because rounding left no room for their cuts.
/// Input: `restarts` counts this one, too.
void lock_for_restart(SegmentTable& segments, std::span<const SegmentId> impossible, int restarts,
                      const RunControl& control) {
  StopCheck check(control);
  for (const SegmentId s : impossible) {
    segments.lock(s);
    if (restarts <= kPatientRestarts) continue;
    for (const SegmentSide& beside : segments.sides(s))
      for (const std::uint32_t side : segments.sides_of_patch(beside.patch)) {
        check();
        segments.lock(segments.all_sides()[side].segment);
      }
  }
  if (restarts < kMaxRestarts) return;
  for (std::size_t s = 0; s < segments.size(); ++s) segments.lock(SegmentId(s));
}

/// Runs one refinement, from the sizes on segments to the refined patches. If rounding leaves no room for a cut, its
/// segment is locked and the refinement restarts. From the first chord on, some more passes need the refiners of all
/// patches. If there are too many triangles, the refiners are not kept in advance; then the first chord restarts the
/// refinement, too.
class Rounds {
 public:
  Rounds(const RefinementInput& input, SegmentTable segments, TriangulatedPatches& triangulated, RunControl& control)
      : input_(input),
        criteria_(input.goals, input.sizes),
        triangulated_(triangulated),
        control_(control),
        progress_(control, input.prediction.expected),
        segments_(std::move(segments)),
        cuts_(segments_, control),
        budget_(input.goals.max_faces, input.max_made) {
    chords_.of_patch.resize(triangulated.size());
  }

  ~Rounds() { free_in_parallel(refiners_.items()); }
  Rounds(const Rounds&) = delete;
  Rounds& operator=(const Rounds&) = delete;

  std::optional<Refinement> run() {
    begin();
    for (int passes = 0, restarts = 0;;) {
      settle();
      if (budget_.is_too_much_made()) return std::nullopt;
      if (!barrier_.impossible.empty()) {
        lock_for_restart(segments_, barrier_.impossible, ++restarts, control_);
        begin();
        continue;
      }
      if (thin_out() && resume_after_thinning()) continue;
      chords_.are_refiners_kept = chords_.are_refiners_kept || count_faces() <= kMaxFacesKept;
      PatchBackup aside = collect_refined(input_, segments_, cuts_, triangulated_, refiners_, chords_.are_refiners_kept,
                                          result_, control_);
      aside.exchange_with(meshes());
      const std::vector<Chord> found =
          find_chords(meshes(), input_.surface.vertex_count() + result_.first_inner, control_);
      const bool was_in_vain = chords_.are_refiners_kept && !chords_.is_any_split;
      if (!can_split_any(found) || passes == kMaxChordPasses || was_in_vain) {
        free_in_parallel(refiners_.items());
        result_.before = std::move(aside);
        const auto why = passes == kMaxChordPasses ? UnrefinedReason::kEffort : UnrefinedReason::kSizeFloor;
        if (!found.empty()) split_chords(input_.surface, triangulated_, result_, input_.is_frozen, why, control_);
        return std::move(result_);
      }
      aside.exchange_with(meshes());
      aside.clear();
      // Most surfaces have no chords, and for large ones two copies of each patch would take too much memory.
      if (!std::exchange(chords_.are_refiners_kept, true)) {
        begin();
        continue;
      }
      ++passes;
      queue_chord_splits(found);
    }
  }

 private:
  /// Limits the number of passes for chords. A point in a chord removes many other chords, but refinement around the
  /// point may make a few new ones.
  static constexpr int kMaxChordPasses = 16;
  /// If there are at most this many triangles, the refiners are kept until it is known whether there are chords.
  /// Together, they take some 60 MB.
  static constexpr std::uint64_t kMaxFacesKept = std::uint64_t{1} << 19;
  /// Limits the number of times that refinement resumes after thinning out. The first times do the main part: the last
  /// one brings only a few per cent.
  static constexpr int kMaxTakenUp = 8, kMaxTakenUpQuickly = 4;
  /// If less than this part of the budget is left, another round over all patches is not worth its time.
  static constexpr double kRoomForMore = 1.0 / 128, kRoomForMoreQuickly = 1.0 / 32;

  PatchMeshes& meshes() { return triangulated_.meshes; }
  bool is_frozen(PatchId p) const { return input_.is_frozen[p] != 0; }

  /// Returns the present number of triangles of a patch.
  std::uint64_t triangle_count(PatchId p) const {
    return refiners_[p] ? refiners_[p]->triangle_count() : triangulated_.meshes[p].mesh.triangle_count();
  }

  /// Runs rounds until no patch has any work.
  void settle() {
    record_made();
    while (!barrier_.dirty.empty() && barrier_.impossible.empty() && !budget_.is_too_much_made()) {
      ++result_.rounds;
      refine_dirty();
      if (budget_.is_too_much_made()) return;
      exchange_cuts();
      record_made();
    }
  }

  /// Returns the present number of triangles, plus those that the messages will make.
  std::uint64_t count_faces() const {
    std::uint64_t faces = 0;
    StopCheck check(control_);
    for (std::size_t p = 0; p < triangulated_.size(); ++p) {
      check();
      faces += triangle_count(PatchId(p));
    }
    for (const SegmentCuts::Message& m : cuts_.messages()) faces += m.count;
    return faces;
  }

  void record_made() {
    if (budget_.is_counted()) budget_.set_made(count_faces());
  }

  /// Thins out all patches, but not after the first chords, because the points in chords have to stay. Returns whether
  /// it was done.
  bool thin_out() {
    if (std::exchange(thinning_.is_done, true) || !criteria_.is_thinned()) return false;
    const auto is_unfinished = [](const auto& refiner) { return refiner != nullptr && !refiner->is_done(); };
    const Thinning thinning =
        std::any_of(refiners_.begin(), refiners_.end(), is_unfinished) ? input_.thinning_in_budget : Thinning::kFull;
    const LargeFirst by_size = large_first(refiners_.size(), 500, [&](std::uint32_t p) -> std::size_t {
      return refiners_[PatchId(p)] ? refiners_[PatchId(p)]->triangle_count() : 0;
    });
    for_each_in(by_size, [&](std::uint32_t p) {
      PatchRefiner* refiner = refiners_[PatchId(p)].get();
      if (refiner == nullptr) return;
      refiner->begin_turn(scratch_.local());
      refiner->thin_out(thinning, control_, progress_);
      refiner->end_turn();
    });
    return true;
  }

  /// If the budget has ended refinement, thinning out may have made room again. Then the patches with work resume. The
  /// number of times is limited, because refinement may add what thinning out removes.
  bool resume_after_thinning() {
    const bool is_quick = input_.thinning_in_budget == Thinning::kQuick;
    if (!budget_.is_limited() || thinning_.times_taken_up == (is_quick ? kMaxTakenUpQuickly : kMaxTakenUp))
      return false;
    for (std::size_t p = 0; p < refiners_.size(); ++p)
      if (refiners_[PatchId(p)] && !refiners_[PatchId(p)]->is_done()) barrier_.dirty.push_back(PatchId(p));
    if (barrier_.dirty.empty()) return false;
    if (!budget_.has_room_for_more(count_faces(), is_quick ? kRoomForMoreQuickly : kRoomForMore)) {
      barrier_.dirty.clear();
      return false;
    }
    ++thinning_.times_taken_up;
    thinning_.is_done = false;
    return true;
  }

  void begin() {
    std::uint64_t faces = 0;
    StopCheck check(control_);
    for (const PatchMesh& patch : meshes()) {
      check();
      faces += patch.mesh.triangle_count();
    }
    progress_.begin(faces);
    barrier_.impossible.clear();
    chords_.is_any_split = true;
    thinning_.is_done = false;
    thinning_.times_taken_up = 0;
    free_in_parallel(refiners_.items());
    refiners_.items().resize(meshes().size());
    above_bounds_ = {};
    result_.new_positions.clear();
    result_.reason.clear();
    const std::uint64_t max = budget_.max_faces();
    cuts_.begin(input_.sizes, budget_.is_limited() ? max - std::min(max, faces) : kNoFaceLimit, budget_.max_made());
    find_dirty();
  }

  /// Finds the patches that have work of their own, or have to apply cuts of their boundary.
  void find_dirty() {
    IdVector<PatchId, std::uint8_t> is_dirty(meshes().size(), 0);
    for_blocks(meshes().size(), 256, control_, [&](std::size_t from, std::size_t to) {
      for (std::size_t i = from; i < to; ++i) {
        const PatchId p(i);
        is_dirty[p] = !is_frozen(p) && PatchRefiner::has_work(meshes()[p], triangulated_.charts[p], criteria_);
      }
    });
    StopCheck check(control_);
    for (const SegmentCuts::Message& m : cuts_.messages()) {
      check();
      is_dirty[m.patch] = 1;
    }
    barrier_.dirty.clear();
    for (std::size_t p = 0; p < is_dirty.size(); ++p) {
      check();
      if (is_dirty[PatchId(p)] != 0) barrier_.dirty.push_back(PatchId(p));
    }
  }

  void refine_dirty() {
    share_out_budget();
    // The order in which the patches run does not change the result.
    const LargeFirst by_work = large_first(barrier_.dirty.size(), 500, [&](std::uint32_t i) -> std::size_t {
      const PatchId p = barrier_.dirty[i];
      return refiners_[p] ? refiners_[p]->waiting() : meshes()[p].mesh.triangle_count();
    });
    above_bounds_.begin_round(barrier_.dirty.size());
    for_each_in(by_work, [&](std::uint32_t i) {
      control_.check();
      if (!budget_.is_too_much_made()) take_turn(barrier_.dirty[i], budget_.share(i));
    });
  }

  /// Refines one patch until it has no work or has made its share of triangles.
  void take_turn(PatchId p, std::uint64_t share) {
    std::unique_ptr<PatchRefiner>& refiner = refiners_[p];
    const auto before = static_cast<std::uint32_t>(triangle_count(p));
    if (!refiner)
      refiner =
          std::make_unique<PatchRefiner>(PatchToRefine{meshes()[p], triangulated_.charts[p], p, segments_}, criteria_,
                                         cuts_.all(), std::min(share, budget_.max_made()), scratch_.local(), control_);
    else
      refiner->begin_turn(scratch_.local());
    refiner->allow_above_bound(above_bounds_.of_turn());
    // A refiner that begins with points of its own numbers its edges anew. So the chords of its patch are left to the
    // next pass, which finds them again.
    if (const auto chords = std::exchange(chords_.of_patch[p], {}); !chords.empty())
      if (refiner->triangle_count() != before || refiner->split_edges(chords, control_)) chords_.is_any_split = true;
    std::uint64_t counted = 0;  // the triangles that messages make were counted with the messages
    for (const SegmentCuts::Message& message : cuts_.messages_for(p)) {
      if (!refiner->impossible().is_valid()) refiner->apply_cuts(message.segment, cuts_[message.segment], control_);
      counted += message.count;
    }
    if (!refiner->impossible().is_valid()) {
      const std::uint64_t made = refiner->triangle_count() - std::min(refiner->triangle_count(), before);
      progress_.add(std::int64_t{refiner->triangle_count()} - before);
      run_turn(*refiner, share - std::min(share, made), made - std::min(made, counted));
    }
    refiner->end_turn();
  }

  /// The number of triangles that a refiner makes between two updates of the total count.
  static constexpr std::uint64_t kSlice = 1 << 16;

  /// Runs one turn. If there are too many triangles, the threads decide which turns come to their end. `begun_with`
  /// counts the triangles that are new in this turn already.
  void run_turn(PatchRefiner& refiner, std::uint64_t share, std::uint64_t begun_with) {
    if (!budget_.is_counted()) return refiner.run(share, progress_);
    budget_.add_made(begun_with);
    const std::uint64_t before = refiner.triangle_count();
    std::uint64_t given = 0;
    for (; given < share && !budget_.is_too_much_made(); given += kSlice) {
      refiner.run(std::min(kSlice, share - given), progress_);
      if (refiner.is_done() || refiner.is_turn_spent() || refiner.impossible().is_valid()) break;
      budget_.add_made(kSlice);
    }
    const std::uint64_t made = refiner.triangle_count() - std::min(before, std::uint64_t{refiner.triangle_count()});
    budget_.add_made(made - std::min(made, given));
  }

  /// Calls `body` for all items in parallel: for each large item alone, and for small items in blocks.
  template <class Body>
  static void for_each_in(const LargeFirst& items, const Body& body) {
    for_all(0, items.large, [&](std::size_t k) { body(items.order[k]); });
    for_ranges(items.large, items.order.size(), 16, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) body(items.order[k]);
    });
  }

  void share_out_budget() {
    std::vector<double> work(barrier_.dirty.size(), 1);
    if (!budget_.is_limited()) return budget_.share_out(0, work, false, control_);
    bool are_all_new = true;
    for (std::size_t i = 0; i < barrier_.dirty.size(); ++i) {
      const PatchRefiner* refiner = refiners_[barrier_.dirty[i]].get();
      are_all_new = are_all_new && refiner == nullptr;
      work[i] = refiner != nullptr ? std::max(1.0, static_cast<double>(refiner->waiting()))
                                   : input_.prediction.of_patch[barrier_.dirty[i].value];
    }
    budget_.share_out(count_faces(), work, are_all_new, control_);
  }

  void exchange_cuts() {
    std::vector<Cut> made;
    std::vector<FreshCut> fresh;
    std::vector<PatchId> unfinished;
    StopCheck check(control_);
    for (const PatchId p : barrier_.dirty) {
      check();
      PatchRefiner& refiner = *refiners_[p];
      if (refiner.impossible().is_valid()) barrier_.impossible.push_back(refiner.impossible());
      above_bounds_.take(refiner.take_above_bound());
      made.clear();
      refiner.take_own_cuts(made);
      for (const Cut& cut : made) fresh.push_back({cut, p});
      if (!refiner.is_done()) unfinished.push_back(p);
    }
    sort_unique(barrier_.impossible, control_);
    if (budget_.is_spent()) unfinished.clear();
    cuts_.exchange(std::move(fresh));
    barrier_.dirty = std::move(unfinished);
    for (const SegmentCuts::Message& m : cuts_.messages()) barrier_.dirty.push_back(m.patch);
    sort_unique(barrier_.dirty, control_);
  }

  bool can_split_any(const std::vector<Chord>& chords) const {
    return std::any_of(chords.begin(), chords.end(), [&](const Chord& c) { return !is_frozen(c.patch); });
  }

  /// Gives chords to their patches, which split them in the next round.
  void queue_chord_splits(const std::vector<Chord>& chords) {
    chords_.is_any_split = false;
    for (const Chord& chord : chords) {
      if (is_frozen(chord.patch)) continue;
      chords_.of_patch[chord.patch].push_back(chord.half_edge);
      barrier_.dirty.push_back(chord.patch);
    }
    sort_unique(barrier_.dirty, control_);
  }

  /// The chords that patches are to split, and the state of this work.
  struct ChordWork {
    /// The chords of each patch, as half-edges of the patches that were collected last.
    IdVector<PatchId, std::vector<std::uint32_t>> of_patch;
    bool are_refiners_kept = false;         ///< patches keep their refiners when they are collected
    std::atomic<bool> is_any_split = true;  ///< whether a chord of the last list was split
  };

  struct ThinningWork {
    /// True if patches were thinned out since they all began, or since they resumed.
    bool is_done = false;
    int times_taken_up = 0;
  };

  /// The state between two rounds.
  struct Barrier {
    std::vector<PatchId> dirty;         ///< the patches that have work, ascending
    std::vector<SegmentId> impossible;  ///< segments that had to be cut where rounding left no room, ascending
  };

  const RefinementInput& input_;
  const Criteria criteria_;
  TriangulatedPatches& triangulated_;
  RunControl& control_;
  RefinementProgress progress_;
  SegmentTable segments_;
  SegmentCuts cuts_;
  FaceBudget budget_;
  ExtraWorkPool above_bounds_;
  PatchRefiners refiners_;
  /// One per thread. Parallel loops inside a turn do not run another patch's turn meanwhile (core/base/parallel.h).
  tbb::enumerable_thread_specific<RefinerScratch> scratch_;
  Barrier barrier_;
  ChordWork chords_;
  ThinningWork thinning_;
  Refinement result_;
};

}  // namespace

std::optional<Refinement> refine(const RefinementInput& input, SegmentTable segments, TriangulatedPatches& triangulated,
                                 RunControl& control) {
  return Rounds(input, std::move(segments), triangulated, control).run();
}

void split_chords(const Surface& surface, TriangulatedPatches& triangulated, Refinement& refinement,
                  const IdVector<PatchId, std::uint8_t>& is_frozen, UnrefinedReason why, RunControl& control) {
  PatchMeshes& meshes = triangulated.meshes;
  IdVector<PatchId, std::size_t> vertices, triangles;
  StopCheck check(control);
  for (const PatchMesh& patch : meshes) {
    check();
    vertices.push_back(patch.vertices.size());
    triangles.push_back(patch.mesh.triangle_count());
  }
  IdVector<PatchId, std::uint8_t> is_aside(meshes.size(), 0);
  for (const PatchId p : refinement.before.ids()) is_aside[p] = 1;
  const auto set_aside = [&](PatchId p) {
    if (std::exchange(is_aside[p], 1) == 0) refinement.before.add(p, meshes[p]);
  };
  split_chords(triangulated, surface.vertex_count() + refinement.first_inner, set_aside, control);
  std::vector<UnrefinedReason> reason;
  auto before = refinement.reason.begin();
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    check();
    const PatchId p(i);
    PatchMesh& patch = meshes[p];
    const std::size_t first = refinement.new_positions.size();
    if (vertices[p] != patch.vertices.size()) {
      refinement.new_positions.resize(first + count_unplaced(patch));
      place_inner_vertices(surface, triangulated.charts[p], patch, first, refinement.new_positions);
    }
    if (refinement.reason.empty()) continue;
    reason.insert(reason.end(), before, before + static_cast<std::ptrdiff_t>(triangles[p]));
    before += static_cast<std::ptrdiff_t>(triangles[p]);
    if (vertices[p] == patch.vertices.size()) continue;
    const std::size_t first_reason = reason.size() - triangles[p];
    reason.resize(first_reason + patch.mesh.triangle_count());
    for (std::uint32_t h = 0; h < patch.mesh.half_edge_count(); ++h)
      if (patch.mesh.from(h) >= vertices[p])
        reason[first_reason + h / 3] = is_frozen[p] != 0 ? UnrefinedReason::kBoundaryLocked : why;
  }
  refinement.reason = std::move(reason);
}

}  // namespace remesh
