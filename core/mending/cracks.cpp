#include "core/mending/cracks.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "core/base/blocks.h"
#include "core/base/diagnostic.h"
#include "core/base/parallel.h"
#include "core/mending/open_edges.h"
#include "core/mending/weld.h"

namespace remesh {
namespace {

constexpr std::size_t kBlock = 256;

/// A crack is no wider than this part of its edges, nor of how far its faces reach from them.
constexpr double kCrackShare = 0.1;

/// The open edge nearest to each that could be its partner.
class NearestPartners {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  NearestPartners(const OpenEdges& open, double tolerance, RunControl& control) : open_(open), tolerance_(tolerance) {
    LooksAtEdges looks(open.size());
    const auto blocks =
        map_blocks<std::vector<std::uint32_t>>(open.size(), kBlock, control, [&](std::size_t begin, std::size_t end) {
          std::vector<std::uint32_t> partners(end - begin, kNone);
          for (std::size_t i = begin; i < end && !looks.are_too_many(); ++i)
            looks.add(find(i, control, partners[i - begin]));
          return partners;
        });
    if (!looks.are_too_many())
      for (const auto& partners : blocks) partner_.insert(partner_.end(), partners.begin(), partners.end());
  }

  /// Ascending.
  std::vector<double> widths() const {
    std::vector<double> widths;
    for (std::uint32_t i = 0; i < partner_.size(); ++i)
      if (partner_[i] != kNone && i < partner_[i] && partner_[partner_[i]] == i)
        widths.push_back(open_.width(i, partner_[i], tolerance_));
    sort_all(widths.begin(), widths.end());
    return widths;
  }

 private:
  static double widest(const OpenEdge& edge) { return kCrackShare * std::min(edge.length, edge.depth); }

  /// Returns how many edges were looked at.
  std::size_t find(std::size_t i, RunControl& control, std::uint32_t& partner) const {
    double width = widest(open_[i]);
    if (!(width > tolerance_)) return 0;
    // Edges that are exactly as far have to be seen, too, so that the order of the input decides nothing.
    double best = std::nextafter(width, HUGE_VAL);
    return open_.search(i, best, control, [&](std::uint32_t j) {
      if (open_[i].face == open_[j].face) return;
      const double to_j = open_.width(i, j, tolerance_);
      if (!(to_j > tolerance_ && to_j <= std::min(width, widest(open_[j])))) return;
      if (to_j == width && partner != kNone && !open_.is_before(j, partner)) return;
      partner = j;
      width = to_j;
      best = width * (1 + 1e-12);
    });
  }

  const OpenEdges& open_;
  double tolerance_;
  std::vector<std::uint32_t> partner_;
};

/// What edges a welded input has.
struct EdgeKinds {
  std::uint64_t open = 0, of_many = 0;
  std::uint64_t lost = 0;  ///< sides of faces that have become a point

  bool is_better_than(const EdgeKinds& other) const {
    return open < other.open && of_many <= other.of_many && lost <= other.lost;
  }
};

EdgeKinds edges_if_welded(const PolygonMesh& input, const Barriers& barriers, double tolerance, RunControl& control) {
  std::vector<Diagnostic> untold;
  const Surface surface = weld(input, barriers, untold, control, tolerance);
  const Adjacency edges(surface.vertex_count(), surface.face_begin, surface.corners, control);
  EdgeKinds kinds;
  std::uint32_t looks = 0;
  for (const EdgeId e : edges.odd_edges()) {
    if (looks++ % 4096 == 0) control.check();
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

/// The next number of two digits that is clearly above a width.
double two_digits_above(double width) {
  const double wanted = 1.01 * width;
  const double unit = std::pow(10.0, std::floor(std::log10(wanted)) - 1);
  return std::stod(few_digits(std::ceil(wanted / unit) * unit));
}

}  // namespace

std::vector<double> crack_widths(const Surface& surface, const Adjacency& edges, double tolerance,
                                 RunControl& control) {
  if (edges.odd_edges().empty()) return {};
  return NearestPartners(OpenEdges(surface, edges, control), tolerance, control).widths();
}

std::string describe_cracks(const std::vector<double>& widths, const PolygonMesh& input, const Options& options,
                            RunControl& control) {
  // Where the widest are no cracks, as the sides of a slot, a smaller tolerance may still be of use.
  constexpr int kMostTries = 4;
  if (widths.empty()) return "";
  std::string text = "; " + std::to_string(2 * widths.size()) + " run beside another one, " +
                     (widths.size() > 1 ? few_digits(widths.front()) + " to " : "") + few_digits(widths.back()) +
                     " apart, which is more than rounding explains, and were not joined";
  const EdgeKinds now = edges_if_welded(input, options.barriers, options.weld_tolerance, control);
  auto end = widths.end();
  for (int i = 0; i < kMostTries && end != widths.begin(); ++i) {
    const double tolerance = two_digits_above(*(end - 1));
    if (tolerance > options.weld_tolerance) {
      const EdgeKinds then = edges_if_welded(input, options.barriers, tolerance, control);
      if (then.is_better_than(now))
        return text + ": weld_tolerance=" + few_digits(tolerance) + " would leave " + std::to_string(then.open) +
               " of the " + std::to_string(now.open) + " edges with one face";
    }
    end = std::upper_bound(widths.begin(), end - 1, *(end - 1) / 2);
  }
  return text + ": no weld_tolerance closes them and nothing else";
}

}  // namespace remesh
