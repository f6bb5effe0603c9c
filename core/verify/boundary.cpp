#include "core/verify/boundary.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"

namespace remesh::verification {
namespace {

constexpr std::size_t kCheckEvery = 8192;

/// Measures of a chain's inner vertices relative to the straight line between its ends.
struct Offset {
  double distance = 0;
  double backwards = 0;      ///< largest distance by which the chain goes back along the line
  bool is_ascending = true;  ///< the chain never goes back or stands still
  double sliver = 0;         ///< area between the chain and the line
};

Offset measure(const Points& points, std::span<const VertexId> chain, RunControl& control) {
  const Vec3 from = points[chain.front().value];
  const Vec3 line = points[chain.back().value] - from;
  const double length = norm(line);
  Offset offset;
  double furthest = 0;
  Vec3 twice_sliver, previous;
  StopCheck check(control);
  for (std::size_t i = 1; i < chain.size(); ++i) {
    check();
    const Vec3 d = points[chain[i].value] - from;
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

class BoundaryCheck {
 public:
  BoundaryCheck(const Model& model, const Seams& seams, FoundFaults& faults, RunControl& control)
      : model_(model), input_(seams.input), output_(seams.output), faults_(faults), control_(control) {
    result_.deviation.assign(model.patch_count(), 0);
    result_.slivers.assign(model.patch_count(), 0);
  }

  Boundary run() {
    std::vector<FoundFault> in_input, in_output;
    std::vector<double> slivers_of_output(model_.patch_count(), 0);
    do_all([&] { walk_input(in_input); }, [&] { walk_output(in_output, slivers_of_output); });
    faults_.add(in_input);
    faults_.add(in_output);
    for (std::size_t p = 0; p < model_.patch_count(); ++p) result_.slivers[p] += slivers_of_output[p];
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

  bool is_in_output(VertexId v) const { return model_.is_in_output[v.value] != 0; }

  void walk_input(std::vector<FoundFault>& found) {
    input_.for_each_chain(
        control_, [&](VertexId v) { return !is_in_output(v); },
        [&](const Chain& chain, std::span<const VertexId> vertices) {
          input_chains_.push_back(chain);
          if (vertices.size() > 2) measure_dropped(input_.edges()[chain.edge], vertices, found);
        },
        [&](const Edge& edge, VertexId v, Stray why) {
          blame(edge, why == Stray::kLoop ? Fault::kLostLoop : Fault::kLostVertex, v, found);
        });
    sort_by_ends(input_chains_);
  }

  void walk_output(std::vector<FoundFault>& found, std::vector<double>& slivers) {
    output_.for_each_chain(
        control_, [&](VertexId v) { return model_.is_new(v); },
        [&](const Chain& chain, std::span<const VertexId> vertices) {
          output_chains_.push_back(chain);
          if (vertices.size() > 2) measure_new(output_.edges()[chain.edge], vertices, found, slivers);
        },
        [&](const Edge& edge, VertexId v, Stray) { blame(edge, Fault::kNewVertex, v, found); });
    sort_by_ends(output_chains_);
  }

  void measure_dropped(const Edge& edge, std::span<const VertexId> chain, std::vector<FoundFault>& found) {
    const Offset offset = measure(model_.points, chain, control_);
    double reach = 0;
    for (const VertexId v : chain)
      reach = std::fmax(reach, norm(model_.points[v.value] - model_.points[chain[0].value]));
    if (!model_.is_within_tolerance(offset.distance, reach) || !model_.is_within_tolerance(offset.backwards, reach))
      blame(edge, Fault::kChord, chain[0], found);
    for (const Use& use : edge.uses) {
      double& deviation = result_.deviation[use.patch().value];
      deviation = std::fmax(deviation, offset.distance);
      result_.slivers[use.patch().value] += offset.sliver;
    }
  }

  void measure_new(const Edge& edge, std::span<const VertexId> chain, std::vector<FoundFault>& found,
                   std::vector<double>& slivers) {
    const Offset offset = measure(model_.points, chain, control_);
    const double reach = std::max(largest_coordinate(model_.points[chain.front().value]),
                                  largest_coordinate(model_.points[chain.back().value]));
    if (!(offset.distance <= Model::rounding(reach)) || !offset.is_ascending)
      blame(edge, Fault::kNewOffLine, chain.front(), found);
    for (const Use& use : edge.uses) slivers[use.patch().value] += offset.sliver;
  }

  /// Merges the chains of both sides, which are sorted by their ends.
  void match_chains() {
    std::size_t o = 0;
    for (std::size_t i = 0; i < input_chains_.size(); ++i) {
      if (i % kCheckEvery == 0) control_.check();
      const Chain& chain = input_chains_[i];
      const Edge& edge = input_.edges()[chain.edge];
      while (o < output_chains_.size() && ends(output_chains_[o]) < ends(chain)) blame_output(o++);
      // A second chain between the same ends would lie on the first one, so two edges have become one.
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
  static std::pair<VertexId, VertexId> ends(const Chain& chain) { return {chain.low, chain.high}; }
  void sort_by_ends(std::vector<Chain>& chains) const {
    const auto by_ends = [](const Chain& a, const Chain& b) {
      return ends(a) != ends(b) ? ends(a) < ends(b) : a.edge < b.edge;
    };
    if (!std::is_sorted(chains.begin(), chains.end(), by_ends))
      sort_stoppable(chains.begin(), chains.end(), control_, by_ends);
  }
  void blame_output(std::size_t o) {
    blame(output_.edges()[output_chains_[o].edge], Fault::kBoundary, output_chains_[o].low);
  }

  /// A vertex may join patches, or parts of one patch, without an edge between them: it is inside one patch, and the
  /// corner of another lies on it. If the vertex stays, it must stay in all of them. If it is dropped, it must not
  /// have joined any.
  void check_joints();
  /// A new vertex must join the patches along its chain, or be inside one patch.
  void check_new_vertices();

  /// Calls visit(vertex, patch, result) for all corners, with one result for each block of faces.
  template <class Result, class Visit>
  std::vector<Result> map_corners(const Faces& faces, const Visit& visit) {
    return map_blocks<Result>(faces.count(), kItemsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
      Result result{};
      for (std::size_t f = begin; f < end; ++f)
        for (const VertexId v : faces.face(f)) visit(v, faces.patch[f], result);
      return result;
    });
  }

  const Model& model_;
  const BoundaryGraph& input_;
  const BoundaryGraph& output_;
  FoundFaults& faults_;
  RunControl& control_;

  std::vector<Chain> input_chains_, output_chains_;
  Boundary result_;
};

/// A corner's vertex and patch in one word, with the vertex in the upper half.
std::uint64_t joint(VertexId v, PatchId p) { return static_cast<std::uint64_t>(v.value) << 32 | p.value; }
VertexId vertex_of(std::uint64_t joint) { return VertexId(static_cast<std::uint32_t>(joint >> 32)); }
PatchId patch_of(std::uint64_t joint) { return PatchId(static_cast<std::uint32_t>(joint)); }

using Joints = std::vector<std::uint64_t>;

/// Merges all joints in ascending order without repetitions.
auto in_order(const std::vector<Joints>& blocks, RunControl& control) {
  auto all = concatenate<std::uint64_t>(blocks, control);
  sort_stoppable(all.begin(), all.end(), control);
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

void BoundaryCheck::check_joints() {
  // Most vertices belong to one patch and need no list.
  constexpr std::uint32_t kUnknown = 0, kSeveral = 0xffffffffu;
  std::vector<std::atomic<std::uint32_t>> only_patch(model_.points.size());  // the number of the patch plus 1
  const auto number = [](PatchId p) { return p.value + 1; };
  const auto of = [&](VertexId v) { return only_patch[v.value].load(std::memory_order_relaxed); };
  // The thread that finds a second patch at a vertex writes down both patches. Every later one writes down its own.
  const auto of_input = map_corners<Joints>(model_.input, [&](VertexId v, PatchId p, Joints& joints) {
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
  auto of_output = map_corners<OfOutput>(model_.output, [&](VertexId v, PatchId p, OfOutput& found) {
    if (model_.is_new(v)) return;
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
  const auto before = in_order(of_input, control_), after = in_order(joints_of_output, control_);

  std::size_t a = 0;
  for (std::size_t b = 0; b < before.size(); ++b) {
    if (b % kCheckEvery == 0) control_.check();
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
      // for a patch that has it inside.
      if (!input_.is_passage_of(v, p)) faults_.add(p, Fault::kLostVertex, v.value);
    }
  }
  for (; a < after.size(); ++a) faults_.add(patch_of(after[a]), Fault::kForeignVertex, vertex_of(after[a]).value);
}

void BoundaryCheck::check_new_vertices() {
  const std::size_t first = model_.surface_vertex_count;
  if (model_.new_vertex_end == first) return;
  std::vector<PatchId> only_patch(model_.new_vertex_end - first);
  for (std::size_t f = 0; f < model_.output.count(); ++f) {
    if (f % kCheckEvery == 0) control_.check();
    const PatchId p = model_.output.patch[f];
    for (const VertexId v : model_.output.face(f)) {
      if (!model_.is_new(v)) continue;
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

Boundary check_boundary(const Model& model, const Seams& seams, FoundFaults& faults, RunControl& control) {
  return BoundaryCheck(model, seams, faults, control).run();
}

}  // namespace remesh::verification
