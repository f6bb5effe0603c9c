#include "core/verify/boundary/boundary.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/grouping.h"
#include "core/base/stoppable.h"
#include "core/verify/boundary/curved_chain.h"

namespace remesh::verification {
namespace {

constexpr std::size_t kCheckEvery = 8192;

/// Measures of the vertices inside a chain, relative to the straight line between its ends.
struct Offset {
  double distance = 0;
  double backwards = 0;      ///< largest distance by which the chain goes back along the line
  bool is_ascending = true;  ///< the chain never goes back or stands still
  double sliver = 0;         ///< area between the chain and the line
};

template <class PointOf>
Offset measure(const PointOf& point_of, std::span<const VertexId> chain, RunControl& control) {
  const Vec3 from = point_of(chain.front());
  const Vec3 line = point_of(chain.back()) - from;
  const double length = norm(line);
  Offset offset;
  double furthest = 0;
  Vec3 twice_sliver, previous;
  StopCheck check(control);
  for (std::size_t i = 1; i < chain.size(); ++i) {
    check();
    const Vec3 d = point_of(chain[i]) - from;
    twice_sliver += cross(previous, d);
    previous = d;
    if (length == 0) {
      offset.distance = std::fmax(offset.distance, norm(d));
      continue;
    }
    const double along = i + 1 == chain.size() ? length : dot(d, line) / length;
    offset.distance = std::fmax(offset.distance, norm(cross(line, d)) / length);
    offset.backwards = std::fmax(offset.backwards, furthest - along);
    offset.is_ascending = offset.is_ascending && along > furthest;
    furthest = std::fmax(furthest, along);
  }
  offset.sliver = norm(twice_sliver) / 2;
  return offset;
}

auto compare_patches(std::span<const Use> a, std::span<const Use> b) {
  return std::lexicographical_compare_three_way(a.begin(), a.end(), b.begin(), b.end(),
                                                [](const Use& u, const Use& v) { return u.patch() <=> v.patch(); });
}

template <class UsesOf>
void sort_by_patches(std::span<Chain> chains, const UsesOf& uses_of, const RunControl& control) {
  if (chains.size() < 2) return;
  sort_stoppable(chains.begin(), chains.end(), control, [&](const Chain& a, const Chain& b) {
    const auto order = compare_patches(uses_of(a), uses_of(b));
    return order != 0 ? order < 0 : a.edge < b.edge;
  });
}

/// The vertices of chains, one chain after the other.
class StoredChains {
 public:
  /// Stores the vertices of a chain from its lower end to its upper end.
  void add(Chain& chain, std::span<const VertexId> walked) {
    chain.stored = static_cast<std::uint32_t>(begin_.size() - 1);
    // A chain that returns to its start was walked downwards.
    if (walked.front() == chain.low && chain.low != chain.high)
      vertices_.insert(vertices_.end(), walked.begin(), walked.end());
    else
      vertices_.insert(vertices_.end(), walked.rbegin(), walked.rend());
    begin_.push_back(vertices_.size());
  }
  /// The points of a chain from its lower end to its upper end.
  template <class PointOf>
  std::vector<Vec3> points(const Chain& chain, const PointOf& point_of) const {
    std::vector<Vec3> all;
    all.reserve(begin_[chain.stored + 1] - begin_[chain.stored]);
    for (std::size_t i = begin_[chain.stored]; i < begin_[chain.stored + 1]; ++i) all.push_back(point_of(vertices_[i]));
    return all;
  }

 private:
  std::vector<VertexId> vertices_;
  std::vector<std::size_t> begin_{0};
};

/// The places of vertices in the input.
struct InputPoints {
  const NumberedClaim& numbered;
  Vec3 operator()(VertexId v) const { return numbered.points[v.value]; }
};
/// The places of vertices in the output.
struct OutputPoints {
  const NumberedClaim& numbered;
  Vec3 operator()(VertexId v) const { return numbered.output_point(v); }
};

/// Calls visit(vertex, patch, result) for all corners of patches that are not kept, with one result for each block of
/// faces.
template <class Result, class Visit>
std::vector<Result> map_corners(const NumberedClaim& numbered, const Faces& faces, RunControl& control,
                                const Visit& visit) {
  return map_blocks<Result>(faces.count(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
    Result result{};
    for (std::size_t f = begin; f < end; ++f)
      if (numbered.is_kept[faces.patch[f].value] == 0)
        for (const VertexId v : faces.face(f)) visit(v, faces.patch[f], result);
    return result;
  });
}

/// Makes a list for the chains of a graph that need not grow. Growing would copy millions of them, and these copies
/// could not be cancelled.
std::vector<Chain> list_for(const BoundaryGraph& graph, RunControl& control) {
  std::vector<Chain> chains;
  control.memory().ask_for<Chain>(graph.edges().size());
  chains.reserve(graph.edges().size());
  return chains;
}

/// Returns how far a chain may be from the one that replaces it. An end may be moved within the tolerance of a curved
/// patch that is not beside the chain. The chain may follow that move, but that patch lends it no more than the move,
/// which its own bound includes.
double allowed_gap(const NumberedClaim& numbered, std::span<const Use> uses, VertexId low, VertexId high) {
  double of_sides = numbered.tolerance;
  for (const Use& use : uses)
    if (const CurvedSurface* surface = numbered.curved_surface(use.patch()); surface != nullptr)
      of_sides = std::max(of_sides, surface->tolerance + numbered.tolerance);
  const auto way = [&](VertexId v) { return norm(numbered.output_point(v) - numbered.points[v.value]); };
  return std::min(std::max({numbered.allowed_move(low), numbered.allowed_move(high), of_sides}),
                  of_sides + std::max(way(low), way(high)));
}

class BoundaryCheck {
 public:
  BoundaryCheck(const NumberedClaim& numbered, const Seams& seams, FoundFaults& faults, RunControl& control)
      : numbered_(numbered), input_(seams.input), output_(seams.output), faults_(faults), control_(control) {
    result_.deviation.assign(numbered.patch_count(), 0);
    result_.slivers.assign(numbered.patch_count(), 0);
    if (!numbered.has_curved()) return;
    for (auto* values : {&result_.on_surface, &result_.near_pole, &result_.allowed})
      values->assign(numbered.patch_count(), 0);
  }

  Boundary run() {
    std::vector<FoundFault> in_input, in_output;
    std::vector<double> slivers_of_output(numbered_.patch_count(), 0);
    do_all(
        numbered_.input.corners.size() + numbered_.output.corners.size(), [&] { walk_input(in_input); },
        [&] { walk_output(in_output, slivers_of_output); });
    faults_.add(in_input);
    faults_.add(in_output);
    for (std::size_t p = 0; p < numbered_.patch_count(); ++p) result_.slivers[p] += slivers_of_output[p];
    match_chains();
    check_joints();
    check_new_vertices();
    return std::move(result_);
  }

 private:
  static void blame(const Edge& edge, Fault fault, VertexId at, std::vector<FoundFault>& found) {
    for (const Use& use : edge.uses) found.push_back({use.patch(), fault, at.value});
  }
  void blame(const Edge& edge, Fault fault, VertexId at) {
    for (const Use& use : edge.uses) faults_.add(use.patch(), fault, at.value);
  }

  /// True if a chain is compared not with the straight line between its ends, but with a chain of the other side.
  bool may_be_cut_anew(const Chain& chain, std::span<const Use> uses) const {
    return numbered_.is_any_curved(uses) || numbered_.is_moved(chain.low) || numbered_.is_moved(chain.high);
  }
  bool is_in_output(VertexId v) const { return numbered_.is_in_output[v.value] != 0; }

  void walk_input(std::vector<FoundFault>& found) {
    input_.for_each_chain(
        control_, [&](VertexId v) { return !is_in_output(v); },
        [&](const Chain& chain, std::span<const VertexId> vertices) {
          input_chains_.push_back(chain);
          if (may_be_cut_anew(chain, input_.edges()[chain.edge].uses))
            stored_input_.add(input_chains_.back(), vertices);
          else if (vertices.size() > 2)
            measure_dropped(input_.edges()[chain.edge], vertices, found);
        },
        [&](const Edge& edge, VertexId v, Stray why) {
          blame(edge, why == Stray::kLoop ? Fault::kLostLoop : Fault::kLostVertex, v, found);
        });
    sort_by_ends(input_chains_);
  }

  void walk_output(std::vector<FoundFault>& found, std::vector<double>& slivers) {
    output_.for_each_chain(
        control_, [&](VertexId v) { return numbered_.is_new(v); },
        [&](const Chain& chain, std::span<const VertexId> vertices) {
          output_chains_.push_back(chain);
          const std::span<const Use> uses = output_.edges()[chain.edge].uses;
          if (may_be_cut_anew(chain, uses)) stored_output_.add(output_chains_.back(), vertices);
          if (!numbered_.is_any_curved(uses) && vertices.size() > 2)
            measure_new(output_.edges()[chain.edge], vertices, found, slivers);
        },
        [&](const Edge& edge, VertexId v, Stray) { blame(edge, Fault::kNewVertex, v, found); });
    sort_by_ends(output_chains_);
  }

  void measure_dropped(const Edge& edge, std::span<const VertexId> chain, std::vector<FoundFault>& found) {
    const Offset offset = measure(InputPoints{numbered_}, chain, control_);
    double reach = 0;
    for (const VertexId v : chain)
      reach = std::fmax(reach, norm(numbered_.points[v.value] - numbered_.points[chain[0].value]));
    const auto is_within = [&](double distance) { return numbered_.is_within_tolerance(distance, reach); };
    if (!is_within(offset.distance) || !is_within(offset.backwards)) blame(edge, Fault::kReplacedSpan, chain[0], found);
    for (const Use& use : edge.uses) {
      double& deviation = result_.deviation[use.patch().value];
      deviation = std::fmax(deviation, offset.distance);
      result_.slivers[use.patch().value] += offset.sliver;
    }
  }

  void measure_new(const Edge& edge, std::span<const VertexId> chain, std::vector<FoundFault>& found,
                   std::vector<double>& slivers) {
    const Offset offset = measure(OutputPoints{numbered_}, chain, control_);
    const double reach = std::max(largest_coordinate(numbered_.output_point(chain.front())),
                                  largest_coordinate(numbered_.output_point(chain.back())));
    if (!(offset.distance <= NumberedClaim::rounding(reach)) || !offset.is_ascending)
      blame(edge, Fault::kNewOffLine, chain.front(), found);
    for (const Use& use : edge.uses) slivers[use.patch().value] += offset.sliver;
  }

  /// Merges the chains of both sides, which are sorted by their ends.
  void match_chains() {
    std::size_t o = 0;
    for (std::size_t i = 0; i < input_chains_.size(); ++i) {
      if (i % kCheckEvery == 0) control_.check_and_move();
      const Chain& chain = input_chains_[i];
      const Edge& edge = input_.edges()[chain.edge];
      while (o < output_chains_.size() && ends(output_chains_[o]) < ends(chain)) blame_output(o++);
      if (numbered_.has_curved()) {
        const auto last = [&](const std::vector<Chain>& chains, std::size_t k) {
          while (k < chains.size() && ends(chains[k]) == ends(chain)) ++k;
          return k;
        };
        const std::size_t i_end = last(input_chains_, i), o_end = last(output_chains_, o);
        if (match_curved(std::span(input_chains_).subspan(i, i_end - i),
                         std::span(output_chains_).subspan(o, o_end - o))) {
          i = i_end - 1;
          o = o_end;
          continue;
        }
      }
      // A second chain between the same ends would lie on the first one. So two edges have become one.
      const bool is_second = i > 0 && ends(input_chains_[i - 1]) == ends(chain);
      if (is_second || o == output_chains_.size() || ends(output_chains_[o]) != ends(chain)) {
        blame(edge, Fault::kBoundary, chain.low);
        continue;
      }
      const Chain& found = output_chains_[o];
      if (!have_same_uses(output_.edges()[found.edge].uses, edge.uses, found.is_flipped != chain.is_flipped)) {
        blame(edge, Fault::kBoundary, chain.low);
        blame_output(o);
      }
      ++o;
    }
    while (o < output_chains_.size()) blame_output(o++);
  }
  /// Matches the chains between two vertices if one of the chains may be cut anew.
  /// Output: false if none may; then nothing has been done.
  bool match_curved(std::span<Chain> input, std::span<Chain> output);
  /// Compares two chains that run between the same vertices along the same patches.
  /// Output: the gap between them; nothing if the patches are not on the same sides.
  std::optional<ChainGap> gap_between(const Chain& input, const Chain& output);
  void add_gap(const Edge& edge, const Chain& chain, const ChainGap& gap);

  static std::pair<VertexId, VertexId> ends(const Chain& chain) { return {chain.low, chain.high}; }
  void sort_by_ends(std::vector<Chain>& chains) const {
    const auto by_ends = [](const Chain& a, const Chain& b) {
      return ends(a) != ends(b) ? ends(a) < ends(b) : a.edge < b.edge;
    };
    if (!std::is_sorted(chains.begin(), chains.end(), by_ends))
      sort_stoppable(chains.begin(), chains.end(), control_, by_ends);
  }
  void blame_output(std::size_t o) { blame_output(output_chains_[o]); }
  void blame_output(const Chain& chain) { blame(output_.edges()[chain.edge], Fault::kBoundary, chain.low); }

  /// A vertex may join patches, or parts of one patch, without an edge between them: it is inside one patch, and the
  /// corner of another lies on it. If the vertex stays, it must stay in all of them. If it is dropped, it must not
  /// have joined any.
  void check_joints();
  /// A new vertex must join the patches along its chain, or be inside one patch.
  void check_new_vertices();

  const NumberedClaim& numbered_;
  const BoundaryGraph& input_;
  const BoundaryGraph& output_;
  FoundFaults& faults_;
  RunControl& control_;

  std::vector<Chain> input_chains_ = list_for(input_, control_), output_chains_ = list_for(output_, control_);
  StoredChains stored_input_, stored_output_;  ///< the chains that may be cut anew
  Boundary result_;
};

std::optional<ChainGap> BoundaryCheck::gap_between(const Chain& input, const Chain& output) {
  const std::span<const Use> uses = input_.edges()[input.edge].uses, found = output_.edges()[output.edge].uses;
  const bool is_loop = input.low == input.high;
  std::optional<ChainGap> best;
  for (const bool is_reversed : {false, true}) {
    if (is_reversed && !is_loop) break;
    if (!have_same_uses(found, uses, (output.is_flipped != input.is_flipped) != is_reversed)) continue;
    if (!may_be_cut_anew(input, uses)) return ChainGap{};  // all these chains have been compared with the line
    const std::vector<Vec3> from = stored_input_.points(input, InputPoints{numbered_});
    std::vector<Vec3> to = stored_output_.points(output, OutputPoints{numbered_});
    if (is_reversed) std::reverse(to.begin(), to.end());
    ChainGap gap = measure_gap(numbered_, from, to, uses, control_);
    if (!best || gap.distance < best->distance) best = std::move(gap);
  }
  return best;
}

void BoundaryCheck::add_gap(const Edge& edge, const Chain& chain, const ChainGap& gap) {
  const VertexId at = chain.low;
  const double allowed = allowed_gap(numbered_, edge.uses, chain.low, chain.high);
  // New vertices were rounded when they were made, so a gap may exceed the allowed distance by one rounding.
  const double reach = largest_coordinate(numbered_.points[at.value]) + gap.distance;
  const double rounding = NumberedClaim::rounding(reach);
  if (!NumberedClaim::is_within(gap.distance, allowed + rounding, reach)) blame(edge, Fault::kReplacedSpan, at);
  for (const PatchGap& of : gap.patches) {
    const std::size_t p = of.patch.value;
    // The distance of each of the two chains from the plane may be the tolerance, on different sides.
    if (!NumberedClaim::is_within(of.off_plane, 2 * numbered_.tolerance + rounding, reach))
      faults_.add(of.patch, Fault::kReplacedSpan, at.value);
    const auto raise = [](double& value, double to) { value = std::fmax(value, to); };
    raise(result_.deviation[p], gap.distance);
    raise(result_.on_surface[p], of.on_surface);
    raise(result_.near_pole[p], of.near_pole);
    raise(result_.allowed[p], allowed);
  }
  for (const Use& use : edge.uses) result_.slivers[use.patch().value] += gap.sliver;
}

bool BoundaryCheck::match_curved(std::span<Chain> input, std::span<Chain> output) {
  const auto in_uses = [&](const Chain& chain) { return input_.edges()[chain.edge].uses; };
  const auto out_uses = [&](const Chain& chain) { return output_.edges()[chain.edge].uses; };
  if (std::none_of(input.begin(), input.end(), [&](const Chain& c) { return may_be_cut_anew(c, in_uses(c)); }))
    return false;
  // Sorting puts chains along the same patches next to each other.
  sort_by_patches(input, in_uses, control_);
  sort_by_patches(output, out_uses, control_);
  // The max number of chains between the same ends along the same patches. If there are more, the result is refused.
  constexpr std::size_t kMaxAlike = 8;
  bool has_straight = false;
  std::size_t o = 0;
  for (std::size_t i = 0; i < input.size();) {
    control_.check();
    std::size_t i_end = i + 1;
    while (i_end < input.size() && compare_patches(in_uses(input[i_end]), in_uses(input[i])) == 0) ++i_end;
    for (; o < output.size() && compare_patches(out_uses(output[o]), in_uses(input[i])) < 0; ++o)
      blame_output(output[o]);
    std::size_t o_end = o;
    while (o_end < output.size() && compare_patches(out_uses(output[o_end]), in_uses(input[i])) == 0) ++o_end;
    // Two straight chains between the same ends would lie on each other.
    const bool is_straight = !may_be_cut_anew(input[i], in_uses(input[i]));
    const std::size_t limit = !is_straight ? kMaxAlike : has_straight ? 0 : 1;
    has_straight = has_straight || is_straight;
    std::vector<bool> is_taken(o_end - o, false);
    for (std::size_t k = i; k < i_end; ++k) {
      std::optional<ChainGap> nearest;
      std::size_t which = 0;
      for (std::size_t c = o; c < std::min(o_end, o + limit) && k - i < limit; ++c) {
        if (is_taken[c - o]) continue;
        std::optional<ChainGap> gap = gap_between(input[k], output[c]);
        if (!gap || (nearest && nearest->distance <= gap->distance)) continue;
        nearest = std::move(gap);
        which = c;
      }
      const Edge& edge = input_.edges()[input[k].edge];
      if (!nearest) {
        blame(edge, Fault::kBoundary, input[k].low);
        continue;
      }
      is_taken[which - o] = true;
      add_gap(edge, input[k], *nearest);
    }
    for (std::size_t c = o; c < o_end; ++c)
      if (!is_taken[c - o]) blame_output(output[c]);
    o = o_end;
    i = i_end;
  }
  for (; o < output.size(); ++o) blame_output(output[o]);
  return true;
}

/// A corner's vertex and patch in one word, with the vertex in the upper half.
std::uint64_t joint(VertexId v, PatchId p) { return static_cast<std::uint64_t>(v.value) << 32 | p.value; }
VertexId vertex_of(std::uint64_t joint) { return VertexId(static_cast<std::uint32_t>(joint >> 32)); }
PatchId patch_of(std::uint64_t joint) { return PatchId(static_cast<std::uint32_t>(joint)); }

using Joints = std::vector<std::uint64_t>;

/// Merges all joints in ascending order without repetitions. Where most vertices have some, as on scans, the joints are
/// put in order vertex by vertex.
auto in_order(const std::vector<Joints>& blocks, const NumberedClaim& numbered, RunControl& control) {
  constexpr std::size_t kFew = 4;
  const std::size_t vertex_count = numbered.points.size();
  auto ordered = concatenate<std::uint64_t>(blocks, control);
  if (kFew * ordered.size() < vertex_count) {
    sort_stoppable(ordered.begin(), ordered.end(), control);
  } else {
    const auto all = ordered;
    const Grouping by_vertex = group_by(
        all.size(), vertex_count, [&](std::uint32_t i) { return vertex_of(all[i]).value; }, control);
    for_blocks(vertex_count, kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
      for (; begin < end; ++begin) {
        const auto first = ordered.begin() + by_vertex.begin[begin];
        const auto last = std::transform(by_vertex[begin].begin(), by_vertex[begin].end(), first,
                                         [&](std::uint32_t i) { return all[i]; });
        sort_stoppable(first, last, control);
      }
    });
  }
  ordered.erase(std::unique(ordered.begin(), ordered.end()), ordered.end());
  return ordered;
}

void BoundaryCheck::check_joints() {
  // Most vertices belong to one patch and need no list.
  constexpr std::uint32_t kUnknown = 0, kSeveral = 0xffffffffu;
  std::vector<std::atomic<std::uint32_t>> only_patch(numbered_.points.size());  // the number of the patch plus 1
  const auto number = [](PatchId p) { return p.value + 1; };
  const auto of = [&](VertexId v) { return only_patch[v.value].load(std::memory_order_relaxed); };
  // A kept patch has the same vertices on both sides. So only the other patches at its vertices are recorded.
  for_blocks(numbered_.input.count(), kItemsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f)
      if (numbered_.is_kept[numbered_.input.patch[f].value] != 0)
        for (const VertexId v : numbered_.input.face(f)) only_patch[v.value].store(kSeveral, std::memory_order_relaxed);
  });
  // The thread that finds a second patch at a vertex records both patches. Every later thread records its own patch.
  const auto of_input =
      map_corners<Joints>(numbered_, numbered_.input, control_, [&](VertexId v, PatchId p, Joints& joints) {
        std::uint32_t only = of(v);
        if (only == number(p)) return;
        if (only == kUnknown && only_patch[v.value].compare_exchange_strong(only, number(p), std::memory_order_relaxed))
          return;
        if (only == number(p)) return;
        joints.push_back(joint(v, p));
        if (only == kSeveral) return;
        joints.push_back(joint(v, PatchId(only - 1)));
        only_patch[v.value].store(kSeveral, std::memory_order_relaxed);
      });
  const auto used =
      map_blocks<std::int64_t>(only_patch.size(), kItemsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
        return std::count_if(only_patch.begin() + static_cast<std::ptrdiff_t>(begin),
                             only_patch.begin() + static_cast<std::ptrdiff_t>(end),
                             [&](const auto& only) { return only.load(std::memory_order_relaxed) != kUnknown; });
      });
  result_.input_vertices = std::accumulate(used.begin(), used.end(), std::int64_t{0});
  struct OfOutput {
    Joints joints;
    std::vector<FoundFault> foreign;
  };
  auto of_output =
      map_corners<OfOutput>(numbered_, numbered_.output, control_, [&](VertexId v, PatchId p, OfOutput& found) {
        if (numbered_.is_new(v)) return;
        if (of(v) == kSeveral)
          found.joints.push_back(joint(v, p));
        else if (of(v) != number(p))
          found.foreign.push_back({p, Fault::kForeignVertex, v.value});
      });
  std::vector<Joints> joints_of_output;
  for (OfOutput& found : of_output) {
    control_.check();
    joints_of_output.push_back(std::move(found.joints));
    faults_.add(found.foreign);
  }
  const auto before = in_order(of_input, numbered_, control_), after = in_order(joints_of_output, numbered_, control_);

  std::size_t a = 0;
  for (std::size_t b = 0; b < before.size(); ++b) {
    if (b % kCheckEvery == 0) control_.check_and_move();
    const VertexId v = vertex_of(before[b]);
    const PatchId p = patch_of(before[b]);
    for (; a < after.size() && after[a] < before[b]; ++a)
      faults_.add(patch_of(after[a]), Fault::kForeignVertex, vertex_of(after[a]).value);
    if (a < after.size() && after[a] == before[b]) {
      ++a;
      continue;
    }
    if (is_in_output(v)) {
      faults_.add(p, Fault::kLostVertex, v.value);
    } else {
      // The vertex was dropped. That is right for the patches along the chain, whose faces there are one fan, but not
      // for a patch that has the vertex inside.
      if (!input_.is_passage_of(v, p)) faults_.add(p, Fault::kLostVertex, v.value);
    }
  }
  for (; a < after.size(); ++a) faults_.add(patch_of(after[a]), Fault::kForeignVertex, vertex_of(after[a]).value);
}

void BoundaryCheck::check_new_vertices() {
  const std::size_t first = numbered_.surface_vertex_count;
  if (numbered_.new_vertex_end == first) return;
  std::vector<PatchId> only_patch(numbered_.new_vertex_end - first);
  for (std::size_t f = 0; f < numbered_.output.count(); ++f) {
    if (f % kCheckEvery == 0) control_.check_and_move();
    const PatchId p = numbered_.output.patch[f];
    for (const VertexId v : numbered_.output.face(f)) {
      if (!numbered_.is_new(v)) continue;
      PatchId& only = only_patch[v.value - first];
      if (!only.is_valid()) only = p;
      if (output_.has(v) ? !output_.is_passage_of(v, p) : only != p) faults_.add(p, Fault::kNewVertex, v.value);
    }
  }
  StopCheck check(control_);
  for (std::size_t i = 0; i < only_patch.size(); ++i) {
    check();
    if (!only_patch[i].is_valid()) faults_.add(PatchId(), Fault::kNewVertex, static_cast<std::uint32_t>(first + i));
  }
}

}  // namespace

Boundary check_boundary(const NumberedClaim& numbered, const Seams& seams, FoundFaults& faults, RunControl& control) {
  return BoundaryCheck(numbered, seams, faults, control).run();
}

}  // namespace remesh::verification
