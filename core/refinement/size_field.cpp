#include "core/refinement/size_field.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/base/blocks.h"
#include "core/refinement/distances.h"

namespace remesh {
namespace {

/// Of the box's diagonal: no size is smaller for a gap's sake.
constexpr double kFloor = 0x1p-12;
/// In plane tolerances.
constexpr double kFloorTolerances = 10;
/// A cell reaches at most this part of the gap in its middle. Smaller, and there are more samples than faces to come;
/// larger, and a gap that shrinks towards the cell's end is seen too late.
constexpr double kReach = 0.5;
/// Sizes between samples where no gradation is asked for: a gap grows by no more than the way from it.
constexpr double kNaturalSlope = 1;
/// A segment's samples. One box about a segment askew to the axes reaches far beside it.
constexpr int kPiecesOfSegment = 2;

}  // namespace

/// Gathers the samples, in local units.
class SizeField::Sampler {
 public:
  Sampler(const Surface& surface, const Goals& goals, double plane_tolerance, RunControl& control)
      : surface_(surface), control_(control), proximity_(goals.proximity) {
    Box3 box;
    for (const Vec3& p : surface.local) box.add(p);
    floor_ = std::max({goals.min_edge_length / surface.unit, kFloor * box.diagonal(),
                       kFloorTolerances * plane_tolerance / surface.unit});
    largest_ = goals.max_edge_length / surface.unit;
  }

  void sample_gaps(const GapSearch& gaps);
  void sample_segments(std::span<const std::array<VertexId, 2>> segments);

  const std::vector<Samples::Entry>& samples() const { return samples_; }

 private:
  /// A part of a patch: some of its triangles, or a piece of one.
  struct Cell {
    PatchId patch;
    std::uint32_t begin = 0, end = 0;  ///< in triangles_; equal: a piece
    Corners3 corners;                  ///< of a piece
  };
  struct Output {
    std::vector<Samples::Entry> samples;
    std::vector<Cell> cells;
  };
  /// What a cell is judged by.
  struct Extent {
    Vec3 middle;  ///< a point of the cell
    double reach = 0;
    FloatBox box;
  };

  Extent extent(const Cell& cell) const;
  void look_at(const GapSearch& gaps, const Cell& cell, bool may_cut, Output& out);
  void cut(const Cell& cell, std::vector<Cell>& cells);
  /// Looks at n cells, `cell_at(i)`, in parallel; the output in their order.
  template <class CellAt>
  std::vector<Cell> look_at_all(const GapSearch& gaps, std::size_t n, const CellAt& cell_at);

  Corners3 corners(const Triangle& t) const {
    return {surface_.local[t[0]], surface_.local[t[1]], surface_.local[t[2]]};
  }
  Cell cell(PatchId patch, std::uint32_t begin, std::uint32_t end) const {
    if (end - begin > 1) return {patch, begin, end, {}};
    return {patch, 0, 0, corners(triangles_[begin])};
  }
  void add(const FloatBox& box, double size, std::vector<Samples::Entry>& to) const {
    to.push_back({box, {FloatBox::rounded_down(std::max(size, floor_))}});
  }

  const Surface& surface_;
  RunControl& control_;
  double proximity_;
  double floor_;
  double largest_;
  std::vector<Triangle> triangles_;  ///< patch after patch; cutting a cell sorts its own
  std::vector<Samples::Entry> samples_;
};

namespace {

Vec3 centroid(const Corners3& t) { return (1.0 / 3) * (t[0] + t[1] + t[2]); }

}  // namespace

SizeField::Sampler::Extent SizeField::Sampler::extent(const Cell& cell) const {
  Extent e;
  double squared_reach = 0;
  const auto reach_for = [&](const Corners3& triangle) {
    for (const Vec3& p : triangle) squared_reach = std::max(squared_reach, norm_squared(p - e.middle));
  };
  if (cell.begin == cell.end) {
    for (const Vec3& p : cell.corners) e.box.add(p);
    e.middle = centroid(cell.corners);
    reach_for(cell.corners);
  } else {
    Box3 box;
    for (std::uint32_t t = cell.begin; t < cell.end; ++t)
      for (const Vec3& p : corners(triangles_[t])) box.add(p);
    e.box.add(box.min);
    e.box.add(box.max);
    // The triangle in the middle of the box stands for all.
    double nearest = HUGE_VAL;
    for (std::uint32_t t = cell.begin; t < cell.end; ++t) {
      const Vec3 c = centroid(corners(triangles_[t]));
      const double d = norm_squared(c - 0.5 * (box.min + box.max));
      if (d < nearest) {
        nearest = d;
        e.middle = c;
      }
    }
    for (std::uint32_t t = cell.begin; t < cell.end; ++t) reach_for(corners(triangles_[t]));
  }
  e.reach = std::sqrt(squared_reach);
  return e;
}

void SizeField::Sampler::look_at(const GapSearch& gaps, const Cell& cell, bool may_cut, Output& out) {
  const Extent e = extent(cell);
  // Beyond that, no place of the cell has a gap that asks for less than the largest size.
  const double limit = proximity_ * largest_ + e.reach;
  const double gap =
      gaps.at(surface_.centre + surface_.unit * e.middle, cell.patch, limit * surface_.unit) / surface_.unit;
  if (gap == HUGE_VAL) return;
  if (may_cut && e.reach > kReach * std::max(gap, proximity_ * floor_)) {
    cut(cell, out.cells);
  } else if (gap / proximity_ < largest_) {
    add(e.box, gap / proximity_, out.samples);
  }
}

void SizeField::Sampler::cut(const Cell& cell, std::vector<Cell>& cells) {
  if (cell.begin == cell.end) {
    // Across the longest side, so that needles become short.
    const Corners3& p = cell.corners;
    int longest = 0;
    for (int i = 1; i < 3; ++i)
      if (norm_squared(p[(i + 1) % 3] - p[i]) > norm_squared(p[(longest + 1) % 3] - p[longest])) longest = i;
    const Vec3 &a = p[longest], &b = p[(longest + 1) % 3], &c = p[(longest + 2) % 3];
    const Vec3 middle = 0.5 * (a + b);
    cells.push_back({cell.patch, 0, 0, {a, middle, c}});
    cells.push_back({cell.patch, 0, 0, {middle, b, c}});
    return;
  }
  Box3 centres;
  for (std::uint32_t t = cell.begin; t < cell.end; ++t) centres.add(centroid(corners(triangles_[t])));
  const Vec3 size = centres.max - centres.min;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::uint32_t middle = cell.begin + (cell.end - cell.begin) / 2;
  std::nth_element(triangles_.begin() + cell.begin, triangles_.begin() + middle, triangles_.begin() + cell.end,
                   [&](const Triangle& s, const Triangle& t) {
                     return std::pair(centroid(corners(s))[axis], s) < std::pair(centroid(corners(t))[axis], t);
                   });
  cells.push_back(this->cell(cell.patch, cell.begin, middle));
  cells.push_back(this->cell(cell.patch, middle, cell.end));
}

template <class CellAt>
std::vector<SizeField::Sampler::Cell> SizeField::Sampler::look_at_all(const GapSearch& gaps, std::size_t n,
                                                                      const CellAt& cell_at) {
  constexpr std::size_t kBlock = 64;
  const bool may_cut = samples_.size() + n <= kMostSamples / 2;
  const std::vector<Output> found = map_blocks<Output>(n, kBlock, control_, [&](std::size_t begin, std::size_t end) {
    Output out;
    for (std::size_t i = begin; i < end; ++i) {
      control_.check();
      look_at(gaps, cell_at(i), may_cut, out);
    }
    return out;
  });
  std::vector<Cell> cells;
  for (const Output& out : found) {
    samples_.insert(samples_.end(), out.samples.begin(), out.samples.end());
    cells.insert(cells.end(), out.cells.begin(), out.cells.end());
  }
  return cells;
}

void SizeField::Sampler::sample_gaps(const GapSearch& gaps) {
  std::vector<std::uint32_t> begin{0};
  for (std::size_t p = 0; p < gaps.patch_count(); ++p) {
    const auto of_patch = gaps.triangles_of(PatchId(p));
    triangles_.insert(triangles_.end(), of_patch.begin(), of_patch.end());
    begin.push_back(static_cast<std::uint32_t>(triangles_.size()));
  }
  // Whole patches first, then what they are cut into, round by round.
  std::vector<Cell> cells =
      look_at_all(gaps, gaps.patch_count(), [&](std::size_t p) { return cell(PatchId(p), begin[p], begin[p + 1]); });
  while (!cells.empty()) cells = look_at_all(gaps, cells.size(), [&](std::size_t i) { return cells[i]; });
}

void SizeField::Sampler::sample_segments(std::span<const std::array<VertexId, 2>> segments) {
  std::size_t count = 0;
  for (const auto& [v, w] : segments) {
    if (++count % 4096 == 0) control_.check();
    const Vec3 &a = surface_.local[v], &b = surface_.local[w];
    const double length = norm(b - a);
    if (length >= largest_) continue;
    for (int i = 0; i < kPiecesOfSegment; ++i) {
      FloatBox box;
      box.add(a + (1.0 * i / kPiecesOfSegment) * (b - a));
      box.add(a + (1.0 * (i + 1) / kPiecesOfSegment) * (b - a));
      add(box, length, samples_);
    }
  }
}

SizeField::SizeField(const Surface& surface, const GapSearch* gaps, std::span<const std::array<VertexId, 2>> segments,
                     const Goals& goals, double plane_tolerance, RunControl& control)
    : largest_(goals.max_edge_length),
      slope_(goals.gradation > 0 ? goals.gradation - 1 : kNaturalSlope),
      centre_(surface.centre),
      unit_(surface.unit) {
  Sampler sampler(surface, goals, plane_tolerance, control);
  if (gaps != nullptr && goals.proximity > 0) sampler.sample_gaps(*gaps);
  if (goals.gradation > 0) sampler.sample_segments(segments);
  samples_ = Samples(sampler.samples(), control);
}

/// Monotone in the box and in the size, rounding included: no node promises more than its samples keep, and the answer
/// does not depend on the order of the search.
inline double SizeField::value(const Samples::Entry& sample, const Vec3& p) const {
  return sample.tag.value + slope_ * std::sqrt(squared_distance(sample.box, p));
}

double SizeField::at(const Vec3& place, Hint& hint) const {
  if (is_uniform()) return largest_;
  const Vec3 p = (1 / unit_) * (place - centre_);
  double best = std::min(largest_ / unit_, value(samples_[hint.slot], p));
  samples_.search(
      best, [&](const Samples::Entry& entry) { return value(entry, p); },
      [&](std::size_t slot) {
        best = value(samples_[slot], p);
        hint.slot = static_cast<std::uint32_t>(slot);
      });
  return best * unit_;
}

}  // namespace remesh
