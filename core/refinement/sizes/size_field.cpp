#include "core/refinement/sizes/size_field.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"
#include "core/geometry/triangles/distances.h"

namespace remesh {
namespace {

/// The min size that a gap or a short edge may cause, as a fraction of the box's diagonal.
constexpr double kFloor = 0x1p-11;
/// The min size that a gap or a short edge may cause, as a multiple of the plane tolerance.
constexpr double kFloorTolerances = 10;
/// A cell reaches at most this fraction of the gap in its middle. With a smaller fraction, there would be more samples
/// than faces in the result; with a larger one, a gap that shrinks towards the end of the cell would be noticed too
/// late. See experiments.md, Cells of the size field.
constexpr double kReach = 0.5;
/// The same limit for gaps that only a part of a cell may face. See experiments.md, Cells of the size field.
constexpr double kReachBeside = 1;
/// Cells larger than this fraction of the box's diagonal are also cut because of patches that lie beside their middle
/// and are joined to their patch, because another place of the cell may face such a patch. If smaller cells were cut
/// for this reason, cells on a curved surface would have to be about as small as its facets are wide.
constexpr double kCoarse = 0x1p-6;

/// The max number of boxes that a look-up in a usual field visits. See experiments.md, Look-ups of sizes.
constexpr double kUsualBoxes = 256;

/// The slot that decided this thread's last question. The next question is usually about a place beside it, so the
/// search begins there. The slot may belong to another field: any slot is a place to begin, and no answer depends on
/// where the search began.
thread_local std::size_t last_found = 0;

/// A convex piece of a triangle: the part inside a box.
class ClippedTriangle {
 public:
  /// Input: With two axes, the box has no end along z.
  ClippedTriangle(const Corners3& triangle, const Box3& box, int axes) {
    for (const Vec3& p : triangle) corners_[size_++] = p;
    for (int axis = 0; axis < axes; ++axis) {
      clip(axis, 1, box.min[axis]);
      clip(axis, -1, -box.max[axis]);
    }
  }

  std::span<const Vec3> corners() const { return std::span(corners_).first(size_); }

 private:
  /// Reduces the piece to the part where sign times the coordinate is at least `least`.
  void clip(int axis, double sign, double least) {
    const auto height = [&](const Vec3& p) { return sign * p[axis] - least; };
    if (std::all_of(corners().begin(), corners().end(), [&](const Vec3& p) { return height(p) >= 0; })) return;
    std::array<Vec3, kMaxCorners> clipped;
    std::size_t count = 0;
    const auto keep = [&](const Vec3& p) {
      if (count < kMaxCorners) clipped[count++] = p;
    };
    for (std::size_t i = 0; i < size_; ++i) {
      const Vec3 &p = corners_[i], &q = corners_[(i + 1) % size_];
      const double from = height(p), to = height(q);
      if (from >= 0) keep(p);
      if ((from >= 0) != (to >= 0)) keep(p + (from / (from - to)) * (q - p));
    }
    corners_ = clipped;
    size_ = count;
  }

  /// There are three corners, and one more for each of six sides. Rounding may make a few more along a side, which can
  /// be left out because they do not change the piece.
  static constexpr std::size_t kMaxCorners = 12;

  std::array<Vec3, kMaxCorners> corners_;
  std::size_t size_ = 0;
};

}  // namespace

/// Collects the samples in local units.
class SizeField::Sampler {
 public:
  Sampler(const Surface& surface, const Goals& goals, double plane_tolerance, RunControl& control)
      : surface_(surface), control_(control), proximity_(goals.proximity) {
    for (const Vec3& p : surface.local) box_.add(p);
    floor_ = std::max({goals.min_edge_length / surface.unit, kFloor * box_.diagonal(),
                       kFloorTolerances * plane_tolerance / surface.unit});
    is_min_edge_user_limit_ = floor_ * surface.unit <= goals.min_edge_length && goals.min_edge_length > 0;
    largest_ = goals.max_edge_length / surface.unit;
    coarse_ = kCoarse * box_.diagonal();
    tolerance_ = plane_tolerance / surface.unit;
    max_faces_looked_for_ = goals.max_faces_looked_for();
    max_samples_ = static_cast<std::size_t>(
        std::clamp<std::uint64_t>(goals.max_faces, SizeField::kFewSamples, SizeField::kMaxSamples));
  }

  void sample_gaps(const GapSearch& gaps, std::uint64_t earlier_steps);
  void sample_segments(std::span<const std::array<VertexId, 2>> segments);

  const std::vector<Sample>& samples() const { return samples_; }
  std::uint64_t steps() const { return work_.taken(); }
  bool is_cut_short() const { return work_.is_spent(); }
  double floor() const { return floor_; }
  bool is_min_edge_user_limit() const { return is_min_edge_user_limit_; }
  void drop_floor() { floor_ = 0; }
  void raise_floor(double to) { floor_ = std::max(floor_, to); }

 private:
  /// A cell is the part of a patch in a box along the patch's own axes. For a planar patch, the box has no end along
  /// the third axis. With these axes, cells do not depend on the orientation of the model. Boxes are cut rather than
  /// triangles, because triangles may be needles, with many of them side by side within one gap.
  struct Cell {
    PatchId patch;
    Box3 box;
    std::vector<std::uint32_t> triangles;  ///< numbered within the patch; all triangles that reach into the box
  };
  struct Output {
    std::vector<Sample> samples;
    std::vector<Cell> cells;
    std::uint64_t steps = 0;  ///< the steps that the searches took
  };

  /// A triangle of a patch, with the bounding box of its part in a cell.
  struct Part {
    std::uint32_t triangle;
    Box3 box;
  };

  void look_at(const GapSearch& gaps, const Cell& cell, bool may_cut, std::uint64_t max_steps, Output& out) const;
  static void cut(PatchId patch, std::span<const Part> parts, const Box3& box, int axes, std::vector<Cell>& cells);
  /// Samples the n cells that cell_at(i) returns, in parallel. The results are in the order of the cells.
  template <class CellAt>
  std::vector<Cell> look_at_all(const GapSearch& gaps, std::size_t n, const CellAt& cell_at);

  /// Returns the corners of a triangle along the axes.
  Corners3 corners(const Triangle& t, const Axes& axes) const {
    return {axes.along(surface_.local[t[0]]), axes.along(surface_.local[t[1]]), axes.along(surface_.local[t[2]])};
  }
  Samples::Entry entry(const FloatBox& box, double size) const {
    return {box, {FloatBox::rounded_down(std::max(size, floor_))}};
  }

  const Surface& surface_;
  RunControl& control_;
  Box3 box_;
  double proximity_;
  double floor_;
  bool is_min_edge_user_limit_;
  double largest_;
  double coarse_;
  double tolerance_;
  std::uint64_t max_faces_looked_for_;
  std::size_t max_samples_;
  WorkBound work_;  ///< the steps of searches for gaps
  std::vector<Sample> samples_;
};

void SizeField::Sampler::look_at(const GapSearch& gaps, const Cell& cell, bool may_cut, std::uint64_t max_steps,
                                 Output& out) const {
  const auto triangles = gaps.triangles_of(cell.patch);
  const Axes& axes = gaps.axes_of(cell.patch);
  // A curved patch may lie in several layers on top of each other.
  const int axis_count = gaps.is_curved(cell.patch) ? 3 : 2;
  std::vector<Vec3> outline;     // corners of all pieces, along the axes
  std::vector<Corners3> pieces;  // the pieces cut into triangles, in space
  std::vector<Part> parts;
  Box3 box;
  for (const std::uint32_t t : cell.triangles) {
    control_.check();
    const ClippedTriangle piece(corners(triangles[t], axes), cell.box, axis_count);
    const auto around = piece.corners();
    if (around.empty()) continue;
    Part part{t, {}};
    for (const Vec3& p : around) {
      outline.push_back(p);
      part.box.add(p);
    }
    box.add(part.box);
    parts.push_back(part);
    for (std::size_t i = 2; i < around.size(); ++i)
      pieces.push_back({axes.in_space(around[0]), axes.in_space(around[i - 1]), axes.in_space(around[i])});
  }
  if (outline.empty()) return;
  // The place of the patch that is nearest to the middle of the box stands for the whole cell.
  const Vec3 centre = 0.5 * (box.min + box.max);
  Vec3 middle;
  const Triangle* on = nullptr;
  double nearest = HUGE_VAL;
  for (const Part& part : parts) {
    const Vec3 p = nearest_on_triangle(centre, corners(triangles[part.triangle], axes));
    if (norm_squared(p - centre) >= nearest) continue;
    nearest = norm_squared(p - centre);
    middle = p;
    on = &triangles[part.triangle];
  }
  double squared_reach = 0;
  for (const Vec3& p : outline) squared_reach = std::max(squared_reach, norm_squared(p - middle));
  const double reach = std::sqrt(squared_reach);

  // Beyond this distance, no gap of any place of the cell makes the size smaller than its max.
  const double limit = (proximity_ * largest_ + reach) * surface_.unit;
  const Vec3 place = surface_.centre + surface_.unit * axes.in_space(middle);
  WorkBound work(max_steps, &control_);
  const double gap = gaps.at(place, cell.patch, limit, on, &work) / surface_.unit;
  const auto is_too_large_for = [&](double distance, double share) {
    return distance < HUGE_VAL && reach > share * std::max(distance, std::max(proximity_, 1.0) * floor_);
  };
  // Another place of the cell may face a patch that the middle does not face.
  const auto is_too_large_beside = [&] {
    constexpr double kMoreThanMatters = 1.1;
    const double near = std::min(limit, kMoreThanMatters / kReachBeside * reach * surface_.unit);
    if (is_too_large_for(gaps.beside(pieces, cell.patch, near, &work) / surface_.unit, kReachBeside)) return true;
    return reach > coarse_ &&
           is_too_large_for(gaps.nearest(place, cell.patch, limit, on, &work) / surface_.unit, kReach);
  };
  const bool is_cut = may_cut && (is_too_large_for(gap, kReach) || is_too_large_beside());
  out.steps += work.taken();
  if (is_cut) {
    cut(cell.patch, parts, box, axis_count, out.cells);
    return;
  }
  const double size = std::max((gap * (1 + 2 * kNoise) + tolerance_) / proximity_, floor_);
  if (size >= largest_ || size == HUGE_VAL) return;
  FloatBox in_space, along_axes;
  for (const Vec3& p : outline) {
    in_space.add(axes.in_space(p));
    along_axes.add(p);
  }
  out.samples.push_back({entry(in_space, size), {cell.patch, along_axes}});
}

/// Cuts a cell in the middle of its longest side along the first two or three axes. `box` is the bounding box of all
/// parts.
void SizeField::Sampler::cut(PatchId patch, std::span<const Part> parts, const Box3& box, int axes,
                             std::vector<Cell>& cells) {
  const Vec3 size = box.max - box.min;
  int axis = size.x >= size.y ? 0 : 1;
  if (axes > 2 && size.z > size[axis]) axis = 2;
  const double middle = 0.5 * (box.min[axis] + box.max[axis]);
  Cell low{patch, box, {}}, high{patch, box, {}};
  low.box.max[axis] = high.box.min[axis] = middle;
  for (const Part& part : parts) {
    if (part.box.max[axis] > middle) high.triangles.push_back(part.triangle);
    if (part.box.min[axis] <= middle) low.triangles.push_back(part.triangle);
  }
  cells.push_back(std::move(low));
  cells.push_back(std::move(high));
}

template <class CellAt>
std::vector<SizeField::Sampler::Cell> SizeField::Sampler::look_at_all(const GapSearch& gaps, std::size_t n,
                                                                      const CellAt& cell_at) {
  const bool may_cut = !work_.is_spent() && samples_.size() + n <= std::max(max_samples_, 4 * gaps.patch_count()) / 2;
  // A search may take some times as long as its share. If all searches of a batch do so, less is left for the batches
  // after it.
  constexpr std::size_t kBatches = 16, kBlocksOfBatch = 16;
  constexpr std::uint64_t kUneven = 4, kMinSteps = 64;
  const std::size_t size = std::max<std::size_t>(1, n / kBatches), block = 1 + size / kBlocksOfBatch;
  std::vector<Cell> cells;
  for (std::size_t first = 0; first < n; first += size) {
    const std::size_t count = std::min(size, n - first);
    const std::uint64_t left = work_.left(), even = left / (n - first);
    const std::uint64_t max_steps =
        even > WorkBound::kNone / kUneven ? left : std::max(kMinSteps, std::min(left, even * kUneven));
    std::vector<Output> found = map_blocks<Output>(count, block, control_, [&](std::size_t begin, std::size_t end) {
      Output out;
      for (std::size_t i = begin; i < end; ++i) {
        control_.check();
        look_at(gaps, cell_at(first + i), may_cut, max_steps, out);
      }
      return out;
    });
    for (Output& out : found) {
      work_.take(out.steps);
      samples_.insert(samples_.end(), out.samples.begin(), out.samples.end());
      std::move(out.cells.begin(), out.cells.end(), std::back_inserter(cells));
    }
  }
  return cells;
}

void SizeField::Sampler::sample_gaps(const GapSearch& gaps, std::uint64_t earlier_steps) {
  const auto whole_patch = [&](std::size_t p) {
    const Vec3 all{HUGE_VAL, HUGE_VAL, HUGE_VAL};
    Cell cell{PatchId(p), {-all, all}, std::vector<std::uint32_t>(gaps.triangles_of(PatchId(p)).size())};
    std::iota(cell.triangles.begin(), cell.triangles.end(), 0u);
    return cell;
  };
  std::size_t triangles = 0;
  for (std::size_t p = 0; p < gaps.patch_count(); ++p) triangles += gaps.triangles_of(PatchId(p)).size();
  work_ = WorkBound(work_of_sizes_after(earlier_steps, kWorkOfSizes.steps(triangles, max_faces_looked_for_)));
  // Whole patches are sampled first, and then the cells into which they are cut, round by round.
  std::vector<Cell> cells = look_at_all(gaps, gaps.patch_count(), whole_patch);
  while (!cells.empty())
    cells = look_at_all(gaps, cells.size(), [&](std::size_t i) -> const Cell& { return cells[i]; });
}

void SizeField::Sampler::sample_segments(std::span<const std::array<VertexId, 2>> segments) {
  std::size_t count = 0;
  for (const auto& [v, w] : segments) {
    if (++count % 4096 == 0) control_.check_and_move();
    const Vec3 &a = surface_.local[v], &b = surface_.local[w];
    const double length = norm(b - a);
    if (length >= largest_) continue;
    FloatBox box;
    box.add(a);
    box.add(b);
    // The segment asks for edges of its own length around it. The size of the sample is a little larger, because
    // otherwise rounding could make the size at the segment smaller than its length, and the segment itself would be
    // too long.
    samples_.push_back({entry(box, length * (1 + 2 * kNoise)), {}, {a, b}});
  }
}

SizeField::SizeField(const Surface& surface, const GapSearch* gaps, std::span<const std::array<VertexId, 2>> segments,
                     const Goals& goals, double plane_tolerance, RunControl& control, double coarsest,
                     std::uint64_t earlier_steps)
    : largest_(goals.max_edge_length),
      slope_(goals.size_slope()),
      centre_(surface.centre),
      unit_(surface.unit),
      is_of_segments_(gaps == nullptr) {
  Sampler sampler(surface, goals, plane_tolerance, control);
  floor_ = sampler.floor() * surface.unit;
  is_min_edge_user_limit_ = sampler.is_min_edge_user_limit();
  sampler.raise_floor(coarsest / surface.unit);
  if (gaps != nullptr) {
    axes_.reserve(gaps->patch_count());
    for (std::size_t p = 0; p < gaps->patch_count(); ++p) axes_.push_back(gaps->axes_of(PatchId(p)));
    sampler.sample_gaps(*gaps, earlier_steps);
    search_steps_ = sampler.steps();
    is_search_cut_short_ = sampler.is_cut_short();
  } else if (goals.gradation > 0) {
    sampler.sample_segments(segments);
  }
  set_samples(sampler.samples(), control);
  drop_dominated(control);
}

SizeField SizeField::without_floor(const Surface& surface, std::span<const std::array<VertexId, 2>> segments,
                                   const Goals& goals, RunControl& control) {
  SizeField field(goals.max_edge_length);
  field.slope_ = goals.size_slope();
  field.centre_ = surface.centre;
  field.unit_ = surface.unit;
  field.is_of_segments_ = true;
  Sampler sampler(surface, goals, 0, control);
  sampler.drop_floor();
  sampler.sample_segments(segments);
  field.set_samples(sampler.samples(), control);
  field.drop_dominated(control);
  return field;
}

SizeField SizeField::rescaled(double proximity, const Goals& goals, RunControl& control) const {
  SizeField field(goals.max_edge_length);
  field.floor_ = floor_;
  field.is_min_edge_user_limit_ = is_min_edge_user_limit_;
  field.slope_ = goals.size_slope();
  field.centre_ = centre_;
  field.unit_ = unit_;
  field.axes_ = axes_;
  const double factor = proximity / goals.proximity;
  std::vector<Sample> samples;
  samples.reserve(samples_.size());
  StopCheck check(control);
  for (std::size_t slot = 0; slot < samples_.size(); ++slot) {
    check();
    Samples::Entry entry = samples_[slot];
    entry.tag.value = FloatBox::rounded_down(std::max(factor * entry.tag.value, floor_ / unit_));
    if (entry.tag.value * unit_ < field.largest_) samples.push_back({entry, cells_[slot]});
  }
  field.set_samples(samples, control);
  // Predictions that are compared with each other must read sizes at the same places.
  field.look_up_cost_ = look_up_cost_;
  return field;
}

SizeField SizeField::within(const Goals& goals, RunControl& control) const {
  SizeField field = *this;
  field.largest_ = std::min(largest_, goals.max_edge_length);
  if (is_uniform() || !(goals.min_edge_length > floor_)) return field;
  field.floor_ = goals.min_edge_length;
  field.is_min_edge_user_limit_ = true;
  const float floor = FloatBox::rounded_down(goals.min_edge_length / unit_);
  std::vector<Sample> samples;
  samples.reserve(samples_.size());
  StopCheck check(control);
  for (std::size_t slot = 0; slot < samples_.size(); ++slot) {
    check();
    Sample sample{samples_[slot], is_of_segments_ ? Cell() : cells_[slot],
                  is_of_segments_ ? segments_[slot] : Segment()};
    sample.entry.tag.value = std::max(sample.entry.tag.value, floor);
    if (!(sample.entry.tag.value * unit_ < field.largest_)) continue;
    samples.push_back(sample);
  }
  field.set_samples(samples, control);
  return field;
}

void SizeField::set_samples(std::span<const Sample> samples, RunControl& control) {
  const auto entries =
      Samples::make_entries(samples.size(), control, [&](std::size_t i, auto& entry) { entry = samples[i].entry; });
  const auto offset = [&](const Size& size) { return offset_of_size(size.value, slope_); };
  samples_ = Samples(entries, control, Offsets<decltype(offset)>{offset});
  const auto in_order = [&](auto& of_slots, auto Sample::*member) {
    of_slots.resize(samples.size());
    for (std::size_t slot = 0; slot < samples.size(); ++slot) of_slots[slot] = samples[samples_.number(slot)].*member;
  };
  if (is_of_segments_)
    in_order(segments_, &Sample::segment);
  else
    in_order(cells_, &Sample::cell);
  if (!is_of_segments_) measure_look_ups(control);
}

/// Counts the boxes that look-ups visit, in the middles of some samples. Each look-up starts without the results of
/// others, so the count does not depend on the threads.
void SizeField::measure_look_ups(RunControl& control) {
  constexpr std::size_t kLookUps = 32;
  const std::size_t stride = samples_.size() / kLookUps + 1;
  std::size_t boxes = 0, look_ups = 0;
  for (std::size_t i = stride / 2; i < samples_.size(); i += stride, ++look_ups) {
    control.check_and_move();
    const FloatBox& box = samples_[i].box;
    Vec3 middle;
    for (int axis = 0; axis < 3; ++axis) middle[axis] = 0.5 * (double{box.min[axis]} + double{box.max[axis]});
    double best = largest_ / unit_;
    samples_.search(
        best,
        [&](const Samples::Entry& entry) {
          ++boxes;
          return size_from(entry, middle);
        },
        [&](std::size_t slot) { best = std::min(best, size_from(slot, middle)); });
  }
  // A field with up to this factor counts as usual, whatever the position of the part.
  constexpr double kAboutUsual = 2;
  const double cost =
      static_cast<double>(boxes) / (kUsualBoxes * static_cast<double>(std::max(look_ups, std::size_t{1})));
  look_up_cost_ = cost < kAboutUsual ? 1 : cost;
}

/// Returns the distance from a sample to a place. Even with rounding, it is not below the distance to the sample's box.
inline double SizeField::distance(std::size_t slot, const Vec3& p) const {
  const double to_box = std::sqrt(squared_distance(samples_[slot].box, p));
  if (!is_of_segments_) {
    const Cell& cell = cells_[slot];
    return std::max(std::sqrt(squared_distance(cell.box, axes_[cell.patch].along(p))), to_box);
  }
  const auto& [a, b] = segments_[slot];
  return std::max(norm(nearest_on_segment(p, a, b) - p), to_box);
}

/// Returns the distance from a sample to the farthest place of the sample `from`.
double SizeField::farthest(std::size_t slot, std::size_t from) const {
  double farthest = 0;
  if (is_of_segments_) {
    for (const Vec3& p : segments_[from]) farthest = std::max(farthest, distance(slot, p));
    return farthest;
  }
  const auto& [patch, box] = cells_[from];
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = ((corner >> axis) & 1) != 0 ? box.max[axis] : box.min[axis];
    farthest = std::max(farthest, distance(slot, axes_[patch].in_space(p)));
  }
  return farthest;
}

/// Returns whether, at each place of this sample, another sample asks for a smaller size. By the triangle inequality
/// that one then asks for a smaller size everywhere.
bool SizeField::is_dominated(std::size_t slot) const {
  const Samples::Entry& sample = samples_[slot];
  const double size = sample.tag.value;
  double best = size;
  samples_.search(
      best,
      [&](const Samples::Entry& entry) {
        return entry.tag.value + slope_ * std::sqrt(squared_farthest(entry.box, sample.box));
      },
      [&](std::size_t other) {
        // One such sample is enough, so the search ends here.
        if (samples_[other].tag.value + slope_ * farthest(other, slot) < size) best = -1;
      });
  return best != size;
}

/// Removes the samples that another one undercuts everywhere. The field stays the same. Behind a wall of one width
/// there are no such samples; where gaps close, most are.
void SizeField::drop_dominated(RunControl& control) {
  constexpr std::size_t kTried = 256, kBlock = 64;
  constexpr double kWorthwhile = 1.0 / 16;
  const std::size_t n = samples_.size(), stride = n / kTried + 1;
  std::size_t dropped = 0, tried = 0;
  for (std::size_t i = 0; i < n; i += stride, ++tried) {
    control.check();
    dropped += is_dominated(i) ? 1 : 0;
  }
  if (!(static_cast<double>(dropped) > kWorthwhile * static_cast<double>(tried))) return;
  const auto needed = select_ids<std::uint32_t>(n, kBlock, control, [&](std::size_t i) { return !is_dominated(i); });
  std::vector<Sample> samples;
  samples.reserve(needed.size());
  for (const std::uint32_t i : needed)
    samples.push_back(is_of_segments_ ? Sample{samples_[i], {}, segments_[i]} : Sample{samples_[i], cells_[i], {}});
  set_samples(samples, control);
}

/// Returns the size that one node or sample asks for, at the place nearest to it within the radius around p. The result
/// never decreases when the sample's size or its distance grows, even with rounding. So the bound of a node is never
/// above the values of its samples, and the answer does not depend on the order of the search.
inline double SizeField::size_from(const Samples::Entry& node, const Vec3& p, double radius) const {
  return node.tag.value + slope_ * std::max(0.0, std::sqrt(squared_distance(node.box, p)) - radius);
}
inline double SizeField::size_from(std::size_t slot, const Vec3& p, double radius) const {
  return samples_[slot].tag.value + slope_ * std::max(0.0, distance(slot, p) - radius);
}

double SizeField::at(const Vec3& place) const { return is_uniform() ? largest_ : local_at(place) * unit_; }

SizeField::Limit SizeField::limit_at(const Vec3& place) const {
  return {largest_, is_uniform() ? largest_ / unit_ : local_at(place), unit_};
}

/// Returns the size at a place in local units. Runs in which sizes vary much spend half their time here and in
/// `allows`. Inlining all calls saves a twentieth of it.
[[gnu::flatten]] double SizeField::local_at(const Vec3& place) const {
  const Vec3 p = local(place);
  double best = largest_ / unit_;
  if (last_found < samples_.size()) best = std::min(best, size_from(last_found, p));
  samples_.search(
      best, [&](const Samples::Entry& entry) { return size_from(entry, p); },
      [&](std::size_t slot) {
        const double size = size_from(slot, p);
        if (size < best) {
          best = size;
          last_found = slot;
        }
      });
  return best;
}

[[gnu::flatten]] bool SizeField::allows(double length, const Vec3& place, double radius) const {
  if (!(length <= largest_)) return false;
  const Vec3 p = local(place);
  const double wanted = length / unit_, near = radius / unit_;
  if (last_found < samples_.size() && size_from(last_found, p, near) < wanted) return false;
  double best = wanted;
  samples_.search(
      best, [&](const Samples::Entry& entry) { return size_from(entry, p, near); },
      [&](std::size_t slot) {
        if (size_from(slot, p, near) < wanted) {
          best = -1;
          last_found = slot;
        }
      });
  return best == wanted;
}

}  // namespace remesh
