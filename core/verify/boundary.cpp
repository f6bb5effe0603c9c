#include "core/verify/boundary.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace remesh::verification {
namespace {

constexpr std::size_t kCheckEvery = 8192;

/// A run of input edges between two kept vertices.
struct Chain {
  VertexId low, high;       ///< its ends
  std::uint32_t edge = 0;   ///< one of its edges: whose uses are those of all
  bool is_flipped = false;  ///< that edge, from its smaller vertex, runs from `high` to `low`
};

/// How far a chain's inner vertices are from the straight line between its ends.
struct Offset {
  double distance = 0;
  double backwards = 0;  ///< largest way that the chain goes back along the line
  double sliver = 0;     ///< area between chain and line
};

Offset measure(const std::vector<Vec3>& points, const std::vector<VertexId>& chain) {
  const Vec3& from = points[chain.front().value];
  const Vec3 line = points[chain.back().value] - from;
  const double length = norm(line);
  Offset offset;
  double furthest = 0;
  Vec3 twice_sliver, previous;
  for (std::size_t i = 1; i < chain.size(); ++i) {
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
    furthest = std::fmax(furthest, along);
  }
  offset.sliver = norm(twice_sliver) / 2;
  return offset;
}

class BoundaryCheck {
 public:
  BoundaryCheck(const Model& model, const std::vector<Edge>& input, const std::vector<Edge>& output, Findings& findings,
                RunControl& control)
      : model_(model), input_(input), output_(output), findings_(findings), control_(control) {
    result_.deviation.assign(model.patch_count(), 0);
    result_.slivers.assign(model.patch_count(), 0);
  }

  Boundary run() {
    link_vertices();
    walk_chains();
    match_chains();
    check_joints();
    return std::move(result_);
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  void blame(const Edge& edge, Fault fault, VertexId at) {
    for (const Use& use : edge.uses) findings_.add(use.patch, fault, at.value);
  }

  /// How many bounding edges meet at each vertex, and the first two of them.
  void link_vertices() {
    degree_.assign(model_.points.size(), 0);
    incident_.assign(model_.points.size(), {kNone, kNone});
    result_.is_on_boundary.assign(model_.points.size(), 0);
    for (std::uint32_t e = 0; e < input_.size(); ++e)
      for (const VertexId v : {input_[e].low, input_[e].high}) {
        if (degree_[v.value] < 2) incident_[v.value][degree_[v.value]] = e;
        ++degree_[v.value];
        result_.is_on_boundary[v.value] = 1;
      }
  }

  bool is_kept(VertexId v) const { return model_.is_kept[v.value] != 0; }

  void walk_chains() {
    is_walked_.assign(input_.size(), false);
    for (std::uint32_t e = 0; e < input_.size(); ++e) {
      if (e % kCheckEvery == 0) control_.check();
      if (is_walked_[e]) continue;
      if (is_kept(input_[e].low))
        walk(input_[e].low, e);
      else if (is_kept(input_[e].high))
        walk(input_[e].high, e);
    }
    // No kept vertex leads to the others.
    for (std::uint32_t e = 0; e < input_.size(); ++e)
      if (!is_walked_[e]) blame(input_[e], Fault::kLostLoop, input_[e].low);
  }

  void walk(VertexId start, std::uint32_t first) {
    chain_.assign(1, start);
    std::uint32_t e = first;
    VertexId v = start;
    for (;;) {
      is_walked_[e] = true;
      v = input_[e].other(v);
      chain_.push_back(v);
      if (is_kept(v)) break;
      if (degree_[v.value] != 2) return blame(input_[e], Fault::kLostVertex, v);
      const std::uint32_t next = incident_[v.value][0] == e ? incident_[v.value][1] : incident_[v.value][0];
      if (is_walked_[next]) return blame(input_[e], Fault::kLostLoop, v);  // no edge of a sound surface
      // Both edges have v as an end; they are walked in one sense if v is the larger end of one and the smaller of the
      // other.
      const bool is_flipped = (input_[e].low == v) == (input_[next].low == v);
      if (!have_same_uses(input_[e].uses, input_[next].uses, is_flipped)) {
        blame(input_[e], Fault::kLostVertex, v);
        return blame(input_[next], Fault::kLostVertex, v);
      }
      e = next;
    }
    const bool is_upwards = start < v;
    chains_.push_back({std::min(start, v), std::max(start, v), first, (input_[first].low == start) != is_upwards});
    if (chain_.size() > 2) measure_chain(input_[first]);
  }

  void measure_chain(const Edge& edge) {
    const Offset offset = measure(model_.points, chain_);
    double reach = 0;
    for (const VertexId v : chain_)
      reach = std::fmax(reach, norm(model_.points[v.value] - model_.points[chain_[0].value]));
    if (!model_.is_within_tolerance(offset.distance, reach) || !model_.is_within_tolerance(offset.backwards, reach))
      blame(edge, Fault::kChord, chain_[0]);
    for (const Use& use : edge.uses) {
      double& deviation = result_.deviation[use.patch.value];
      deviation = std::fmax(deviation, offset.distance);
      result_.slivers[use.patch.value] += offset.sliver;
    }
  }

  /// Merges chains and output edges, both ordered by their ends.
  void match_chains() {
    const auto key = [](const auto& e) { return std::pair(e.low, e.high); };
    const auto by_ends = [&](const Chain& a, const Chain& b) {
      return key(a) != key(b) ? key(a) < key(b) : a.edge < b.edge;
    };
    if (!std::is_sorted(chains_.begin(), chains_.end(), by_ends))
      tbb::parallel_sort(chains_.begin(), chains_.end(), by_ends);
    std::size_t o = 0;
    for (std::size_t c = 0; c < chains_.size(); ++c) {
      if (c % kCheckEvery == 0) control_.check();
      const Chain& chain = chains_[c];
      while (o < output_.size() && key(output_[o]) < key(chain)) blame_output(o++);
      if (o < output_.size() && key(output_[o]) == key(chain)) {
        // A second chain between the same ends finds no edge left: two edges became one.
        if (!have_same_uses(output_[o].uses, input_[chain.edge].uses, chain.is_flipped)) {
          blame(input_[chain.edge], Fault::kBoundary, chain.low);
          blame_output(o);
        }
        ++o;
      } else {
        blame(input_[chain.edge], Fault::kBoundary, chain.low);
      }
    }
    while (o < output_.size()) blame_output(o++);
  }
  void blame_output(std::size_t o) { blame(output_[o], Fault::kBoundary, output_[o].low); }

  /// A vertex may join patches, or parts of one, without an edge between them: one patch inside, another's corner on
  /// it. Where it stays, it stays for all; where it goes, it had joined nothing.
  void check_joints();

  const Model& model_;
  const std::vector<Edge>& input_;
  const std::vector<Edge>& output_;
  Findings& findings_;
  RunControl& control_;

  std::vector<std::uint32_t> degree_;
  std::vector<std::array<std::uint32_t, 2>> incident_;
  std::vector<bool> is_walked_;
  std::vector<VertexId> chain_;
  std::vector<Chain> chains_;
  Boundary result_;
};

/// A corner's vertex and patch in one word, vertex first.
std::uint64_t joint(VertexId v, PatchId p) { return static_cast<std::uint64_t>(v.value) << 32 | p.value; }
VertexId vertex_of(std::uint64_t joint) { return VertexId(static_cast<std::uint32_t>(joint >> 32)); }
PatchId patch_of(std::uint64_t joint) { return PatchId(static_cast<std::uint32_t>(joint)); }

void sort_unique(std::vector<std::uint64_t>& items) {
  tbb::parallel_sort(items.begin(), items.end());
  items.erase(std::unique(items.begin(), items.end()), items.end());
}

void BoundaryCheck::check_joints() {
  // Most vertices belong to one patch, and need no list.
  std::vector<PatchId> only_patch(model_.points.size());
  std::vector<std::uint8_t> is_shared(model_.points.size(), 0);
  const auto for_each_corner = [&](const Faces& faces, const auto& visit) {
    for (std::size_t f = 0; f < faces.count(); ++f) {
      if (f % kCheckEvery == 0) control_.check();
      for (const VertexId v : faces.face(f)) visit(v, faces.patch[f]);
    }
  };
  for_each_corner(model_.input, [&](VertexId v, PatchId p) {
    PatchId& only = only_patch[v.value];
    if (!only.is_valid())
      only = p;
    else if (only != p)
      is_shared[v.value] = 1;
  });
  std::vector<std::uint64_t> before, after;
  for_each_corner(model_.input, [&](VertexId v, PatchId p) {
    if (is_shared[v.value]) before.push_back(joint(v, p));
  });
  for_each_corner(model_.output, [&](VertexId v, PatchId p) {
    if (is_shared[v.value])
      after.push_back(joint(v, p));
    else if (only_patch[v.value] != p)
      findings_.add(p, Fault::kForeignVertex, v.value);
  });
  sort_unique(before);
  sort_unique(after);

  std::size_t a = 0;
  for (std::size_t b = 0; b < before.size(); ++b) {
    if (b % kCheckEvery == 0) control_.check();
    const VertexId v = vertex_of(before[b]);
    const PatchId p = patch_of(before[b]);
    for (; a < after.size() && after[a] < before[b]; ++a)
      findings_.add(patch_of(after[a]), Fault::kForeignVertex, vertex_of(after[a]).value);
    if (a < after.size() && after[a] == before[b]) {
      ++a;
      continue;
    }
    if (is_kept(v)) {
      findings_.add(p, Fault::kLostVertex, v.value);
    } else {
      // Dropped: fine for the patches along the chain, whose faces there are one fan; not for one that has it inside.
      const auto uses = degree_[v.value] == 2 ? input_[incident_[v.value][0]].uses : std::span<const Use>();
      if (std::none_of(uses.begin(), uses.end(), [p](const Use& use) { return use.patch == p; }))
        findings_.add(p, Fault::kLostVertex, v.value);
    }
  }
  for (; a < after.size(); ++a) findings_.add(patch_of(after[a]), Fault::kForeignVertex, vertex_of(after[a]).value);
}

}  // namespace

Boundary check_boundary(const Model& model, const std::vector<Edge>& input, const std::vector<Edge>& output,
                        Findings& findings, RunControl& control) {
  return BoundaryCheck(model, input, output, findings, control).run();
}

}  // namespace remesh::verification
