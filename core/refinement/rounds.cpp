#include "core/refinement/rounds.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/drop.h"
#include "core/base/large_first.h"
#include "core/base/stoppable.h"
#include "core/geometry/projection.h"
#include "core/refinement/chords.h"
#include "core/refinement/patch_refiner.h"

namespace remesh {
namespace {

/// Returns the way from the plane of the frame, whose origin is a vertex, to the plane that fits the patch best. It is
/// null if the two planes are the same up to rounding.
Vec3 plane_offset(const Surface& surface, const Plane& plane, const Vec3& origin) {
  const Vec3 local = (1 / surface.unit) * (origin - surface.centre);
  const double height = plane.distance(local);
  const double magnitude = std::max({std::fabs(origin.x), std::fabs(origin.y), std::fabs(origin.z), surface.unit});
  if (std::fabs(height) * surface.unit < 0x1p-48 * magnitude) return {};
  return (-height * surface.unit) * plane.normal;
}

/// Counts the vertices inside the patch that have no id yet.
std::size_t count_unplaced(const PatchMesh& patch) {
  return static_cast<std::size_t>(
      std::count_if(patch.vertices.begin(), patch.vertices.end(), [](VertexId v) { return !v.is_valid(); }));
}

/// Gives these vertices ids and positions: those of the new vertices from `first` on.
void place_inner_vertices(const Surface& surface, const Plane& plane, PatchMesh& patch, std::size_t first,
                          std::vector<Vec3>& new_positions) {
  const Vec3 offset = plane_offset(surface, plane, patch.frame.origin);
  for (std::size_t v = 0; v < patch.vertices.size(); ++v) {
    if (patch.vertices[v].is_valid()) continue;
    patch.vertices[v] = VertexId(surface.vertex_count() + first);
    new_positions[first++] = to_space(patch.frame, patch.uv[v]) + offset;
  }
}

constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();

/// Runs one refinement, from the sizes on segments to the refined patches. If rounding leaves no room for a cut, its
/// segment is locked and everything begins again. It also begins again at the first chord, because from then on the
/// refiners of patches must be there for some more passes.
class Rounds {
 public:
  Rounds(const Surface& surface, const PatchSet& patches, const std::vector<std::uint8_t>& is_frozen,
         const Goals& goals, const SizeField& sizes, SegmentTable segments, const Prediction& prediction,
         std::vector<PatchMesh>& meshes, std::uint64_t most_made, RunControl& control)
      : surface_(surface),
        patches_(patches),
        is_frozen_(is_frozen),
        goals_(goals),
        sizes_(sizes),
        criteria_(goals, sizes),
        prediction_(prediction),
        meshes_(meshes),
        most_made_(most_made),
        control_(control),
        progress_(control, prediction.expected),
        segments_(std::move(segments)) {}

  ~Rounds() {
    drop_all(refiners_);
    drop_all(refined_);
  }
  Rounds(const Rounds&) = delete;
  Rounds& operator=(const Rounds&) = delete;

  std::optional<Refinement> run() {
    chords_.resize(meshes_.size());
    begin();
    for (int passes = 0;;) {
      settle();
      if (is_too_much_made()) return std::nullopt;
      if (!impossible_.empty()) {
        for (const SegmentId s : impossible_) segments_.lock(s);
        begin();
        continue;
      }
      if (thin_out() && take_up_again()) continue;
      finish();
      exchange_refined();
      const std::vector<Chord> chords = find_chords(meshes_, surface_.vertex_count() + result_.first_inner, control_);
      if (!can_split_any(chords) || passes == kMaxChordPasses || (is_waiting_for_chords_ && !is_any_split_)) {
        drop_all(refiners_);
        drop_all(refined_);
        const auto why = passes == kMaxChordPasses ? UnrefinedReason::kEffort : UnrefinedReason::kSizeFloor;
        if (!chords.empty()) split_chords(surface_, patches_, meshes_, result_, is_frozen_, why, control_);
        return std::move(result_);
      }
      exchange_refined();
      refined_.clear();
      // Most surfaces have none, and need not keep two of each patch.
      if (!std::exchange(is_waiting_for_chords_, true)) {
        begin();
        continue;
      }
      ++passes;
      take_on(chords);
    }
  }

 private:
  /// Limits the number of passes for chords. A point in a chord ends many other chords, and what is refined around it
  /// may make a few new ones.
  static constexpr int kMaxChordPasses = 16;
  /// Limits the number of times that refinement goes on after thinning out. Most is done by then: the last time brings
  /// only a few per cent.
  static constexpr int kMaxTakenUp = 8;
  /// If less than one kRoomForMore-th of the budget is left, a round over all patches is not worth while.
  static constexpr std::uint64_t kRoomForMore = 128;
  /// This is the number of patches in a task. It is small because a patch may have thousands of triangles.
  static constexpr std::size_t kPatches = 16;
  static constexpr std::size_t kSegments = 1024;

  /// A message is about cuts along a segment that other patches made and `patch` has to make too.
  struct Message {
    PatchId patch;
    SegmentId segment;
    std::uint64_t count = 0;  ///< cuts that are new to the patch
    friend bool operator<(const Message& a, const Message& b) {
      return a.patch != b.patch ? a.patch < b.patch : a.segment < b.segment;
    }
    friend bool operator==(const Message&, const Message&) = default;
  };

  /// A cut, and a patch that made it. If several patches made it in the same round, each has an entry.
  struct FreshCut {
    Cut cut;
    PatchId by;
    friend bool operator<(const FreshCut& a, const FreshCut& b) { return a.cut == b.cut ? a.by < b.by : a.cut < b.cut; }
  };

  /// Runs rounds until no patch has anything to do.
  void settle() {
    note_made();
    while (!dirty_.empty() && impossible_.empty() && !is_too_much_made()) {
      ++result_.rounds;
      refine_dirty();
      if (is_too_much_made()) return;
      exchange_cuts();
      note_made();
    }
  }

  /// Returns the number of triangles that there are, plus those that the messages will make.
  std::uint64_t count_faces() const {
    std::uint64_t faces = 0;
    StopCheck check(control_);
    for (std::size_t p = 0; p < meshes_.size(); ++p) {
      check();
      faces += refiners_[p] ? refiners_[p]->triangle_count() : meshes_[p].mesh.triangle_count();
    }
    for (const Message& m : messages_) faces += m.count;
    return faces;
  }

  void note_made() {
    if (most_made_ != kNoLimit) made_ = count_faces();
  }
  bool is_too_much_made() const { return made_ > most_made_; }

  /// Thins out all patches. This is not done after the first chords, because the points in chords have to stay. Returns
  /// whether it was done.
  bool thin_out() {
    if (std::exchange(is_thinned_out_, true) || !criteria_.has_sizes) return false;
    const LargeFirst by_size = large_first(refiners_.size(), 500, [&](std::uint32_t p) -> std::size_t {
      return refiners_[p] ? refiners_[p]->triangle_count() : 0;
    });
    for_each_in(by_size, [&](std::uint32_t p) {
      if (!refiners_[p]) return;
      refiners_[p]->begin_turn(workplaces_.local());
      refiners_[p]->thin_out(control_, progress_);
      refiners_[p]->end_turn();
    });
    return true;
  }

  /// If the budget has ended refinement, thinning out may have made room again. Then the patches that have something to
  /// do go on. The number of times is limited, because what is refined and what is thinned out may be the same.
  bool take_up_again() {
    if (goals_.max_faces == kNoLimit || times_taken_up_ == kMaxTakenUp) return false;
    for (std::uint32_t p = 0; p < refiners_.size(); ++p)
      if (refiners_[p] && !refiners_[p]->is_done()) dirty_.push_back(p);
    if (dirty_.empty()) return false;
    if (count_faces() > goals_.max_faces - goals_.max_faces / kRoomForMore) {
      dirty_.clear();
      return false;
    }
    ++times_taken_up_;
    is_thinned_out_ = false;
    return true;
  }

  void begin() {
    const std::size_t n = meshes_.size();
    progress_.begin(std::accumulate(
        meshes_.begin(), meshes_.end(), std::uint64_t{0},
        [](std::uint64_t faces, const PatchMesh& patch) { return faces + patch.mesh.triangle_count(); }));
    impossible_.clear();
    is_any_split_ = true;
    is_thinned_out_ = false;
    times_taken_up_ = 0;
    drop_all(refiners_);
    refiners_.resize(n);
    messages_.clear();
    dirty_.clear();
    cuts_.assign(segments_.size(), {});
    for_blocks(segments_.size(), kSegments, control_, [&](std::size_t from, std::size_t to) {
      for (std::size_t s = from; s < to; ++s) {
        control_.check();
        cuts_[SegmentId(s)] = segments_.size_cuts(SegmentId(s), sizes_);
      }
    });
    thin_out_cuts();
    result_.new_positions.clear();
    result_.reason.clear();
    std::vector<std::uint8_t> is_dirty(n, 0);
    for_blocks(n, 256, control_, [&](std::size_t from, std::size_t to) {
      for (std::size_t p = from; p < to; ++p)
        is_dirty[p] = is_frozen_[p] == 0 && PatchRefiner::has_work(meshes_[p], criteria_);
    });
    StopCheck check(control_);
    for (const SegmentSide& side : segments_.all_sides()) {
      check();
      if (cuts_[side.segment].empty()) continue;
      is_dirty[side.patch.value] = 1;
      messages_.push_back({side.patch, side.segment, cuts_[side.segment].size()});
    }
    sort_messages();
    for (std::size_t p = 0; p < n; ++p) {
      check();
      if (is_dirty[p] != 0) dirty_.push_back(static_cast<std::uint32_t>(p));
    }
  }

  /// If the cuts for sizes alone would take more than the budget, all segments are cut less often, in the same
  /// proportion. Half of the budget is for what patches do inside.
  void thin_out_cuts() {
    if (goals_.max_faces == kNoLimit) return;
    std::uint64_t faces = 0, cuts = 0;
    StopCheck check(control_);
    for (const PatchMesh& patch : meshes_) {
      check();
      faces += patch.mesh.triangle_count();
    }
    for (const SegmentSide& side : segments_.all_sides()) {
      check();
      cuts += cuts_[side.segment].size();
    }
    const std::uint64_t most = goals_.max_faces - std::min(goals_.max_faces, faces);
    if (cuts <= most) return;
    const double share = static_cast<double>(most) / 2 / static_cast<double>(cuts);
    for (std::vector<double>& of_segment : cuts_) {
      check();
      const std::size_t pieces = of_segment.size() + 1;
      const auto kept = std::max<std::size_t>(1, static_cast<std::size_t>(share * static_cast<double>(pieces)));
      // There are never more cuts than before. Each is taken as much later than the one before it.
      for (std::size_t i = 1; i < kept; ++i) {
        check();
        of_segment[i - 1] = of_segment[i * pieces / kept - 1];
      }
      of_segment.resize(kept - 1);
    }
  }

  void sort_messages() {
    sort_stoppable(messages_.begin(), messages_.end(), control_);
    messages_.erase(std::unique(messages_.begin(), messages_.end()), messages_.end());
  }

  void refine_dirty() {
    choose_quotas();
    // The order in which they run changes nothing.
    const LargeFirst by_work = large_first(dirty_.size(), 500, [&](std::uint32_t i) -> std::size_t {
      const std::uint32_t p = dirty_[i];
      return refiners_[p] ? refiners_[p]->waiting() : meshes_[p].mesh.triangle_count();
    });
    for_each_in(by_work, [&](std::uint32_t i) {
      control_.check();
      if (is_too_much_made()) return;
      const std::uint32_t p = dirty_[i];
      std::unique_ptr<PatchRefiner>& refiner = refiners_[p];
      Workplace& at = workplaces_.local();
      const std::uint32_t before = refiner ? refiner->triangle_count() : meshes_[p].mesh.triangle_count();
      if (!refiner)
        refiner = std::make_unique<PatchRefiner>(meshes_[p], PatchId(p), segments_, criteria_, cuts_,
                                                 std::min(quota_[i], most_made_), at, control_);
      else
        refiner->begin_turn(at);
      // A refiner that begins with points of its own numbers its edges anew. So its chords are left for the next pass,
      // which finds them again.
      if (const auto chords = std::exchange(chords_[p], {}); !chords.empty())
        if (refiner->triangle_count() != before || refiner->split_edges(chords, control_)) is_any_split_ = true;
      auto message = std::lower_bound(messages_.begin(), messages_.end(), Message{PatchId(p), SegmentId(0), 0});
      for (; message != messages_.end() && message->patch == PatchId(p); ++message)
        if (!refiner->impossible().is_valid()) refiner->take_over(message->segment, cuts_[message->segment]);
      if (!refiner->impossible().is_valid()) {
        const std::uint64_t made = refiner->triangle_count() - std::min(refiner->triangle_count(), before);
        progress_.add(std::int64_t{refiner->triangle_count()} - before);
        run_turn(*refiner, quota_[i] - std::min(quota_[i], made), made);
      }
      refiner->end_turn();
    });
  }

  /// A refiner is asked for this number of triangles at once if all triangles that are made are counted.
  static constexpr std::uint64_t kSlice = 1 << 16;

  /// Runs one turn and adds its triangles to `made_`. During turns, `made_` only grows, and each turn adds the same
  /// whenever it runs. So whether there are too many triangles does not depend on the threads. If there are, it does
  /// depend on them which turns come to their end. `begun_with` counts the triangles that are new in this turn already.
  void run_turn(PatchRefiner& refiner, std::uint64_t quota, std::uint64_t begun_with) {
    if (most_made_ == kNoLimit) return refiner.run(quota, progress_);
    made_ += begun_with;
    for (std::uint64_t given = 0; given < quota && !is_too_much_made(); given += kSlice) {
      refiner.run(std::min(kSlice, quota - given), progress_);
      if (refiner.is_done() || refiner.impossible().is_valid()) return;
      made_ += kSlice;
    }
  }

  /// Calls `body` for all items in parallel: the large ones one by one, the others in blocks.
  template <class Body>
  static void for_each_in(const LargeFirst& items, const Body& body) {
    for_all(std::size_t{0}, items.large, [&](std::size_t k) { body(items.order[k]); });
    for_all(tbb::blocked_range<std::size_t>(items.large, items.order.size(), 16), [&](const auto& range) {
      for (std::size_t k = range.begin(); k < range.end(); ++k) body(items.order[k]);
    });
  }

  /// It may take this number of triangles to mend one or two bad ones.
  static constexpr std::uint64_t kWorthwhile = 16;
  bool is_budget_spent() const { return goals_.max_faces != kNoLimit && left_ < kWorthwhile; }

  /// Decides how many triangles each dirty patch may make. This depends on the state at the barrier alone. While all of
  /// the patches are still to begin, the budget is shared out by what is predicted, so that lattices fit. Later, half
  /// of it is shared out by the work that waits and half evenly: one bad triangle may take a thousand others, and a
  /// patch that is stopped only by its share comes back in a round of its own.
  void choose_quotas() {
    quota_.assign(dirty_.size(), kNoLimit);
    if (goals_.max_faces == kNoLimit) return;
    std::uint64_t faces = count_faces();
    double waiting = 0;
    const auto share = [&](std::uint32_t p) {
      return refiners_[p] ? std::max(1.0, static_cast<double>(refiners_[p]->waiting())) : prediction_.of_patch[p];
    };
    for (const std::uint32_t p : dirty_) waiting += share(p);
    // A step may make a few more faces than its quota has left.
    constexpr std::uint64_t kLastStep = 1;
    faces += kLastStep * dirty_.size();
    left_ = goals_.max_faces - std::min(goals_.max_faces, faces);
    // If little is left for each patch, only the first of them get a share. It is large enough to be worth a round.
    if (left_ / dirty_.size() < kWorthwhile) {
      std::fill(quota_.begin(), quota_.end(), 0);
      std::fill_n(quota_.begin(), left_ / kWorthwhile, kWorthwhile);
      return;
    }
    const auto left = static_cast<double>(left_);
    const bool are_all_new =
        std::none_of(dirty_.begin(), dirty_.end(), [&](std::uint32_t p) { return refiners_[p] != nullptr; });
    const double even = are_all_new ? 1.0 / 8 : 1.0 / 2;
    StopCheck check(control_);
    for (std::size_t i = 0; i < dirty_.size(); ++i) {
      check();
      quota_[i] = static_cast<std::uint64_t>((1 - even) * left * share(dirty_[i]) / waiting) +
                  static_cast<std::uint64_t>(even * left / static_cast<double>(dirty_.size()));
    }
  }

  void exchange_cuts() {
    std::vector<Cut> made;
    std::vector<FreshCut> fresh;
    std::vector<std::uint32_t> unfinished;
    StopCheck check(control_);
    for (std::size_t i = 0; i < dirty_.size(); ++i) {
      check();
      PatchRefiner& refiner = *refiners_[dirty_[i]];
      if (refiner.impossible().is_valid()) impossible_.push_back(refiner.impossible());
      made.clear();
      refiner.take_own_cuts(made);
      for (const Cut& cut : made) fresh.push_back({cut, PatchId(dirty_[i])});
      if (!refiner.is_done()) unfinished.push_back(dirty_[i]);
    }
    sort_stoppable(impossible_.begin(), impossible_.end(), control_);
    impossible_.erase(std::unique(impossible_.begin(), impossible_.end()), impossible_.end());
    if (is_budget_spent()) unfinished.clear();
    sort_stoppable(fresh.begin(), fresh.end(), control_);
    messages_.clear();
    for (auto from = fresh.begin(); from != fresh.end();) {
      check();
      const SegmentId s = from->cut.segment;
      const auto first = from;
      auto to = from;
      std::vector<double>& cuts = cuts_[s];
      const std::size_t old = cuts.size();
      for (; to != fresh.end() && to->cut.segment == s; ++to)
        if (to == first || to->cut.t != (to - 1)->cut.t) cuts.push_back(to->cut.t);
      const std::uint64_t count = cuts.size() - old;
      std::inplace_merge(cuts.begin(), cuts.begin() + static_cast<std::ptrdiff_t>(old), cuts.end());
      from = to;
      const auto sides = segments_.sides(s);
      // If only one patch has the segment, no other patch needs a message.
      if (sides.front().patch == sides.back().patch) continue;
      for (const SegmentSide& side : sides) {
        const auto own =
            static_cast<std::uint64_t>(std::count_if(first, to, [&](const FreshCut& c) { return c.by == side.patch; }));
        if (own < count) messages_.push_back({side.patch, s, count - own});
      }
    }
    sort_messages();
    dirty_ = std::move(unfinished);
    for (const Message& m : messages_) dirty_.push_back(m.patch.value);
    sort_stoppable(dirty_.begin(), dirty_.end(), control_);
    dirty_.erase(std::unique(dirty_.begin(), dirty_.end()), dirty_.end());
  }

  /// Makes the patches as they are now, and gives new vertices ids. The vertices on segments come first, segment after
  /// segment, and then those inside patches, patch after patch.
  void finish() {
    const std::size_t n = meshes_.size(), old = surface_.vertex_count();
    std::vector<std::uint32_t> first_cut(segments_.size() + 1, 0);
    StopCheck check(control_);
    for (std::size_t s = 0; s < segments_.size(); ++s) {
      check();
      first_cut[s + 1] = first_cut[s] + static_cast<std::uint32_t>(cuts_[SegmentId(s)].size());
    }
    result_.first_inner = first_cut[segments_.size()];
    at_work_ = select_ids<PatchId>(n, kItemsPerBlock, control_, [&](std::size_t p) { return refiners_[p] != nullptr; });
    refined_.clear();
    refined_.resize(at_work_.size());
    std::vector<std::vector<UnrefinedReason>> reasons(at_work_.size());
    // These are first the counts for each patch at work, and for each patch. Then they become the sums over all patches
    // before it.
    std::vector<std::size_t> first_inner(at_work_.size() + 1, 0), first_triangle(n + 1, 0);
    for_blocks(n, kItemsPerBlock, control_, [&](std::size_t p, std::size_t end) {
      for (; p < end; ++p) first_triangle[p + 1] = meshes_[p].mesh.triangle_count();
    });
    for_blocks(at_work_.size(), kPatches, control_, [&](std::size_t i, std::size_t end) {
      for (; i < end; ++i) {
        std::unique_ptr<PatchRefiner>& refiner = refiners_[at_work_[i].value];
        PatchRefiner::Refined patch = refiner->finish();
        if (!is_waiting_for_chords_) refiner.reset();
        for (std::size_t v = 0; v < patch.cuts.size(); ++v) {
          const Cut& cut = patch.cuts[v];
          if (!cut.segment.is_valid()) continue;
          const std::vector<double>& cuts = cuts_[cut.segment];
          const auto k = std::lower_bound(cuts.begin(), cuts.end(), cut.t) - cuts.begin();
          patch.patch.vertices[v] = VertexId(old + first_cut[cut.segment.value] + static_cast<std::size_t>(k));
        }
        first_inner[i + 1] = count_unplaced(patch.patch);
        first_triangle[at_work_[i].value + 1] = patch.patch.mesh.triangle_count();
        reasons[i] = std::move(patch.reason);
        refined_[i] = std::move(patch.patch);
      }
    });
    first_inner[0] = result_.first_inner;
    std::partial_sum(first_inner.begin(), first_inner.end(), first_inner.begin());
    std::partial_sum(first_triangle.begin(), first_triangle.end(), first_triangle.begin());
    result_.new_positions.resize(first_inner.back());
    // A patch without a refiner stays as it was, because it is frozen or has nothing to do.
    result_.reason.assign(first_triangle[n], UnrefinedReason::kSizeFloor);
    for (std::size_t p = 0; p < n; ++p)
      if (is_frozen_[p] != 0)
        std::fill(result_.reason.begin() + static_cast<std::ptrdiff_t>(first_triangle[p]),
                  result_.reason.begin() + static_cast<std::ptrdiff_t>(first_triangle[p + 1]),
                  UnrefinedReason::kBoundaryLocked);
    for_blocks(segments_.size(), kSegments, control_, [&](std::size_t s, std::size_t end) {
      for (; s < end; ++s) {
        const std::vector<double>& cuts = cuts_[SegmentId(s)];
        for (std::size_t k = 0; k < cuts.size(); ++k)
          result_.new_positions[first_cut[s] + k] = segments_.position(SegmentId(s), cuts[k]);
      }
    });
    for_blocks(at_work_.size(), kPatches, control_, [&](std::size_t i, std::size_t end) {
      for (; i < end; ++i) {
        const PatchId p = at_work_[i];
        place_inner_vertices(surface_, patches_.planes[p], refined_[i], first_inner[i], result_.new_positions);
        std::copy(reasons[i].begin(), reasons[i].end(),
                  result_.reason.begin() + static_cast<std::ptrdiff_t>(first_triangle[p.value]));
      }
    });
  }

  /// Swaps the patches that `finish` made with the patches that they were before refinement.
  void exchange_refined() {
    for (std::size_t i = 0; i < at_work_.size(); ++i) std::swap(meshes_[at_work_[i].value], refined_[i]);
  }

  bool can_split_any(const std::vector<Chord>& chords) const {
    return std::any_of(chords.begin(), chords.end(), [&](const Chord& c) { return is_frozen_[c.patch.value] == 0; });
  }

  /// Gives chords to their patches, which split them in the next round.
  void take_on(const std::vector<Chord>& chords) {
    is_any_split_ = false;
    for (const Chord& chord : chords) {
      if (is_frozen_[chord.patch.value] != 0) continue;
      chords_[chord.patch.value].push_back(chord.half_edge);
      dirty_.push_back(chord.patch.value);
    }
    sort_stoppable(dirty_.begin(), dirty_.end(), control_);
    dirty_.erase(std::unique(dirty_.begin(), dirty_.end()), dirty_.end());
  }

  const Surface& surface_;
  const PatchSet& patches_;
  const std::vector<std::uint8_t>& is_frozen_;
  const Goals& goals_;
  const SizeField& sizes_;
  const Criteria criteria_;
  const Prediction& prediction_;
  std::vector<PatchMesh>& meshes_;
  const std::uint64_t most_made_;
  RunControl& control_;
  RefinementProgress progress_;
  SegmentTable segments_;
  IdVector<SegmentId, std::vector<double>> cuts_;  ///< ascending cuts of each segment
  std::vector<std::unique_ptr<PatchRefiner>> refiners_;
  /// There is one per thread. Parallel loops inside a turn do not run another patch's turn meanwhile
  /// (core/base/parallel.h).
  tbb::enumerable_thread_specific<Workplace> workplaces_;
  std::vector<std::uint32_t> dirty_;  ///< patches, ascending
  std::vector<std::uint64_t> quota_;  ///< one per dirty patch
  /// This counts the triangles at the last barrier, plus at least those that turns have made since then.
  std::atomic<std::uint64_t> made_ = 0;
  std::uint64_t left_ = kNoLimit;  ///< what was left of the budget when it was last shared out
  std::vector<Message> messages_;  ///< sorted
  std::vector<SegmentId> impossible_;
  std::vector<PatchId> at_work_;  ///< the patches that had a refiner when `finish` was called
  /// These are the patches at work as `finish` has made them, or, after a swap, as they were before.
  std::vector<PatchMesh> refined_;
  std::vector<std::vector<std::uint32_t>> chords_;  ///< chords of each patch, as half-edges of `finish`'s result
  /// True if patches were thinned out since they all began, or since they were taken up again.
  bool is_thinned_out_ = false;
  int times_taken_up_ = 0;
  bool is_waiting_for_chords_ = false;     ///< patches keep their refiners after `finish`
  std::atomic<bool> is_any_split_ = true;  ///< a chord of the last list was split
  Refinement result_;
};

}  // namespace

std::optional<Refinement> refine(const Surface& surface, const PatchSet& patches,
                                 const std::vector<std::uint8_t>& is_frozen, const Goals& goals, const SizeField& sizes,
                                 SegmentTable segments, const Prediction& prediction, std::vector<PatchMesh>& meshes,
                                 std::uint64_t most_made, RunControl& control) {
  return Rounds(surface, patches, is_frozen, goals, sizes, std::move(segments), prediction, meshes, most_made, control)
      .run();
}

void split_chords(const Surface& surface, const PatchSet& patches, std::vector<PatchMesh>& meshes,
                  Refinement& refinement, const std::vector<std::uint8_t>& is_frozen, UnrefinedReason why,
                  RunControl& control) {
  std::vector<std::size_t> vertices, triangles;
  StopCheck check(control);
  for (const PatchMesh& patch : meshes) {
    check();
    vertices.push_back(patch.vertices.size());
    triangles.push_back(patch.mesh.triangle_count());
  }
  split_chords(meshes, surface.vertex_count() + refinement.first_inner, control);
  std::vector<UnrefinedReason> reason;
  auto before = refinement.reason.begin();
  for (std::size_t p = 0; p < meshes.size(); ++p) {
    check();
    PatchMesh& patch = meshes[p];
    const std::size_t first = refinement.new_positions.size();
    refinement.new_positions.resize(first + count_unplaced(patch));
    place_inner_vertices(surface, patches.planes[PatchId(p)], patch, first, refinement.new_positions);
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
