#include "core/mending/edges/cracks.h"

#include <algorithm>
#include <cmath>

#include "core/base/blocks.h"
#include "core/base/diagnostic.h"
#include "core/base/ids.h"
#include "core/base/loop_progress.h"
#include "core/base/number_text.h"
#include "core/base/stoppable.h"
#include "core/geometry/trees/box_tree.h"
#include "core/mending/edges/open_edges.h"
#include "core/mending/edges/seams.h"
#include "core/mending/edges/t_junctions.h"
#include "core/mending/weld/weld.h"

namespace remesh {
namespace {

constexpr std::size_t kCrackBlock = 256;

/// The largest width of a crack, relative to the length of its edges and to how far its faces reach from them.
constexpr double kCrackShare = 0.1;

/// The widest crack of which an edge may be a side.
double widest(const OpenEdge& edge) { return kCrackShare * std::min(edge.length, edge.depth); }

/// The nearest partner that was found for an open edge, and the width of the crack between them.
struct Nearest {
  std::uint32_t partner = kNone;
  double width = 0;
};

/// Calls find(i, nearest) for all edges. `find` returns how many other edges it tested. Output: empty if there were too
/// many tests.
template <class Find>
std::vector<Nearest> find_all(std::size_t edges, RunControl& control, const Find& find) {
  constexpr std::size_t kManyLooks = 1 << 12;
  LooksAtEdges looks(edges);
  LoopProgress progress(control, edges);
  const auto blocks =
      map_blocks<std::vector<Nearest>>(edges, kCrackBlock, control, [&](std::size_t begin, std::size_t end) {
        std::vector<Nearest> nearest(end - begin);
        std::size_t told = begin;
        for (std::size_t i = begin; i < end && !looks.are_too_many(); ++i) {
          const std::size_t seen = find(i, nearest[i - begin]);
          looks.add(seen);
          // If very many edges have one middle, a block of them may take seconds.
          if (seen < kManyLooks) continue;
          progress.add(i + 1 - told);
          told = i + 1;
        }
        progress.add(end - told);
        return nearest;
      });
  std::vector<Nearest> all;
  if (looks.are_too_many()) return all;
  for (const auto& nearest : blocks) all.insert(all.end(), nearest.begin(), nearest.end());
  return all;
}

/// Finds pairs of edges whose ends are near each other, both at one end and at the other.
class Pairs {
 public:
  Pairs(const OpenEdges& open, double tolerance, RunControl& control)
      : open_(open), tolerance_(tolerance), control_(control) {}

  std::size_t find(std::size_t i, Nearest& nearest) const {
    nearest.width = widest(open_[i]);
    if (!(nearest.width > tolerance_)) return 0;
    // Edges at exactly the same distance must be found, too, so that the order of the input does not matter.
    double best = std::nextafter(nearest.width, HUGE_VAL);
    return open_.search(i, best, control_, [&](std::uint32_t j) {
      if (open_[i].face == open_[j].face) return;
      const double to_j = open_.fit(i, j, tolerance_).width;
      if (!(to_j > tolerance_ && to_j <= std::min(nearest.width, widest(open_[j])))) return;
      if (to_j == nearest.width && nearest.partner != kNone && !open_.is_before(j, nearest.partner)) return;
      nearest = {j, to_j};
      best = to_j * (1 + 1e-12);
    });
  }

 private:
  const OpenEdges& open_;
  double tolerance_;
  RunControl& control_;
};

/// Finds edges that run along another one without having the same ends.
class Alongside {
 public:
  Alongside(const Surface& surface, const OpenEdges& open, double tolerance, RunControl& control)
      : surface_(surface), open_(open), tolerance_(tolerance), control_(control) {
    const auto entries = Tree::make_entries(open.size(), control, [&](std::size_t i, Tree::Entry& entry) {
      for (const VertexId v : {open[i].from, open[i].to}) {
        entry.box.add(surface.local[v]);
        entry.tag.box.add(surface.local[v]);
      }
    });
    tree_ = Tree(entries, control);
  }

  std::size_t find(std::size_t i, Nearest& nearest) const {
    nearest.width = widest(open_[i]);
    if (!(nearest.width > tolerance_)) return 0;
    double best = std::nextafter(nearest.width, HUGE_VAL);
    const Vec3 middle = open_.middle(i);
    const auto bound = [&](const Tree::Entry& entry) {
      const Box3& box = entry.tag.box;
      return norm({excess(box.min.x, box.max.x, middle.x), excess(box.min.y, box.max.y, middle.y),
                   excess(box.min.z, box.max.z, middle.z)});
    };
    StopCheck check(control_);
    std::size_t looks = 0;
    tree_.search(best, bound, [&](std::size_t slot) {
      check();
      ++looks;
      const std::uint32_t j = tree_.number(slot);
      if (open_[i].face == open_[j].face) return;
      const double to_j = width(open_[i], open_[j]);
      if (!(to_j > tolerance_ && to_j <= std::min(nearest.width, widest(open_[j])))) return;
      if (open_.do_lie_on_each_other(i, j, to_j)) return;
      if (to_j == nearest.width && nearest.partner != kNone && !open_.is_before(j, nearest.partner)) return;
      nearest = {j, to_j};
      best = to_j * (1 + 1e-12);
    });
    return looks;
  }

 private:
  struct ExactBox {
    Box3 box;
    void join(const ExactBox& other) { box.add(other.box); }
  };
  using Tree = BoxTree<ExactBox>;

  /// The largest distance of an edge from the line of another one, over the part where they run beside each other. This
  /// part must be at least half of the shorter one; otherwise the result is infinite.
  double width(const OpenEdge& edge, const OpenEdge& other) const {
    constexpr double kBeside = 0.5;
    const Vec3 a = surface_.local[other.from], p = surface_.local[edge.from], q = surface_.local[edge.to];
    const Vec3 way = (1 / other.length) * (surface_.local[other.to] - a);
    const double at_p = dot(p - a, way), at_q = dot(q - a, way);
    const double from = std::max(0.0, std::min(at_p, at_q)), to = std::min(other.length, std::max(at_p, at_q));
    if (!(to - from >= kBeside * std::min(edge.length, other.length))) return HUGE_VAL;
    const auto distance = [&](double along) {
      const Vec3 place = p + ((along - at_p) / (at_q - at_p)) * (q - p);
      return norm(place - (a + along * way));
    };
    return std::max(distance(from), distance(to));
  }

  const Surface& surface_;
  const OpenEdges& open_;
  double tolerance_;
  RunControl& control_;
  Tree tree_;
};

/// The numbers of edges of each kind that an input has after joining.
struct EdgeKinds {
  std::uint64_t welded_open = 0;  ///< open edges after welding alone
  std::uint64_t open = 0, of_many = 0;
  std::uint64_t lost = 0;  ///< edges of faces that have become a point

  bool is_better_than(const EdgeKinds& other) const {
    return open < other.open && of_many <= other.of_many && lost <= other.lost;
  }
};

/// Joins the input as preparation with a weld tolerance would do it, and counts its edges.
class Trial {
 public:
  Trial(const PolygonMesh& input, const Options& options, const CrackRules& rules, RunControl& control)
      : input_(input), options_(options), rules_(rules), control_(control) {}

  EdgeKinds run(double tolerance) const {
    std::vector<Diagnostic> untold;
    Surface surface = weld(input_, options_.barriers, untold, control_, tolerance);
    const auto adjacency = [&] {
      return Adjacency(surface.vertex_count(), surface.face_begin, surface.corners, control_);
    };
    const EdgeKinds welded = count(adjacency());
    // A weld tolerance above the rounding leaves no seams.
    const bool has_seams = options_.repair.seams && tolerance < rules_.rounding;
    Seams seams({rules_.rounding / surface.unit, options_.repair.winding});
    if (has_seams) seams.close(surface, adjacency(), MendMode::kYes, control_);
    bool is_split = false;
    const auto split_at = [&](double near) {
      is_split |= split_t_junctions(surface, adjacency(), near / surface.unit, {}, MendMode::kYes, untold, control_);
    };
    if (options_.repair.t_junctions) split_at(rules_.plane_tolerance);
    if (options_.repair.t_junctions && tolerance > rules_.plane_tolerance) split_at(tolerance);
    if (has_seams && is_split) seams.close(surface, adjacency(), MendMode::kYes, control_);
    EdgeKinds kinds = count(adjacency());
    kinds.welded_open = welded.open;
    // Corners of a polygon that only splitting and seams make coincide are mended later, so they do not count.
    kinds.lost = welded.lost;
    return kinds;
  }

 private:
  EdgeKinds count(const Adjacency& edges) const {
    EdgeKinds kinds;
    StopCheck check(control_);
    for (const EdgeId e : edges.odd_edges()) {
      check();
      const auto around = edges.half_edges(e);
      if (edges.from(around[0]) == edges.to(around[0]))
        kinds.lost += around.size();
      else if (around.size() == 1)
        ++kinds.open;
      else if (around.size() > 2)
        ++kinds.of_many;
    }
    return kinds;
  }

  const PolygonMesh& input_;
  const Options& options_;
  const CrackRules& rules_;
  RunControl& control_;
};

/// The next number of two digits that is clearly above a width.
double two_digits_above(double width) {
  const double wanted = 1.01 * width;
  const double unit = std::pow(10.0, std::floor(std::log10(wanted)) - 1);
  return std::stod(number_text(std::ceil(wanted / unit) * unit, 2));
}

}  // namespace

Cracks find_cracks(const Surface& surface, const Adjacency& edges, double rounding, RunControl& control) {
  Cracks cracks;
  if (edges.odd_edges().empty()) return cracks;
  const OpenEdges open(surface, edges, OpenEdges::Which::kOpen, control);
  const double tolerance = rounding / surface.unit;
  const Pairs pairs(open, tolerance, control);
  const auto partners = find_all(open.size(), control, [&](std::size_t i, Nearest& n) { return pairs.find(i, n); });
  if (partners.empty()) return cracks;
  const auto has_partner = [&](std::size_t i) {
    const std::uint32_t partner = partners[i].partner;
    return partner != kNone && partners[partner].partner == i;
  };
  const Alongside alongside(surface, open, tolerance, control);
  const auto beside = find_all(open.size(), control, [&](std::size_t i, Nearest& n) -> std::size_t {
    return has_partner(i) ? 0 : alongside.find(i, n);
  });
  StopCheck check(control);
  for (std::uint32_t i = 0; i < open.size(); ++i) {
    check();
    const bool is_one_of_two = has_partner(i);
    if (!is_one_of_two && (beside.empty() || beside[i].partner == kNone)) continue;
    ++cracks.edges;
    if (is_one_of_two && partners[i].partner < i) continue;
    cracks.widths.push_back((is_one_of_two ? partners[i].width : beside[i].width) * surface.unit);
  }
  sort_stoppable(cracks.widths.begin(), cracks.widths.end(), control);
  return cracks;
}

Advice describe_cracks(const Cracks& cracks, const PolygonMesh& input, const Options& options, const CrackRules& rules,
                       RunControl& control) {
  // The widest gaps may be no cracks but, for example, the sides of a slot. Then a smaller tolerance may still close
  // the cracks.
  constexpr int kMaxTries = 4;
  const std::vector<double>& widths = cracks.widths;
  if (widths.empty()) return {};
  std::string text = "; " + std::to_string(cracks.edges) + " of these edges run beside another open edge, " +
                     (widths.size() > 1 ? number_text(widths.front(), 2) + " to " : "") +
                     number_text(widths.back(), 2) +
                     " apart, which is more than the rounding of the coordinates explains, and were not joined";
  const Trial trial(input, options, rules, control);
  const EdgeKinds now = trial.run(options.weld_tolerance);
  auto end = widths.end();
  for (int i = 0; i < kMaxTries && end != widths.begin(); ++i) {
    const double tolerance = two_digits_above(*(end - 1));
    if (tolerance > options.weld_tolerance) {
      const EdgeKinds then = trial.run(tolerance);
      if (then.is_better_than(now)) {
        const std::string option = "weld_tolerance=" + number_text(tolerance, 2);
        const std::string effect = "would leave " + std::to_string(then.open) + " of the " +
                                   std::to_string(now.welded_open) + " edges that have only one face";
        return {text + ": " + option + " " + effect, {{option, effect}}};
      }
    }
    end = std::upper_bound(widths.begin(), end - 1, *(end - 1) / 2);
  }
  return {text + ": no `weld_tolerance` was found that closes edges without damage elsewhere", {}};
}

}  // namespace remesh
