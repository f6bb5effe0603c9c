#include "core/verify/patches/patch_shape.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/run_control.h"
#include "core/base/stoppable.h"
#include "core/geometry/trees/box_tree.h"
#include "core/geometry/triangles/distances.h"
#include "core/verify/model/face_measures.h"
#include "core/verify/model/fixed_width_integers.h"
#include "core/verify/model/numbered_claim.h"
#include "core/verify/patches/curved_patch.h"
#include "core/verify/patches/height_measure.h"

namespace remesh::verification {
namespace {

using Boxes = BoxTree<NoTag>;

Corners3 corners_of(const NumberedClaim& numbered, std::uint32_t output_face) {
  const auto face = numbered.output.face(output_face);
  return {numbered.output_point(face[0]), numbered.output_point(face[1]), numbered.output_point(face[2])};
}

/// The distance of points from the output's triangles of one patch.
class OutputDistance {
 public:
  OutputDistance(const NumberedClaim& numbered, std::size_t patch, RunControl& control)
      : numbered_(numbered), faces_(numbered.output_by_patch[patch]), control_(control) {
    const auto entries = Boxes::make_entries(faces_.size(), control, [&](std::size_t i, Boxes::Entry& entry) {
      for (const Vec3& p : corners_of(numbered, faces_[i])) entry.box.add(p);
    });
    boxes_ = Boxes(entries, control);
  }

  double from(const Vec3& p) const {
    control_.check();
    double nearest = HUGE_VAL;
    boxes_.search(
        nearest, [&](const Boxes::Entry& e) { return squared_distance(e.box, p); },
        [&](std::size_t slot) {
          const Vec3 q = nearest_on_triangle(p, corners_of(numbered_, faces_[boxes_.number(slot)]));
          nearest = std::min(nearest, norm_squared(q - p));
        });
    return std::sqrt(nearest);
  }

 private:
  const NumberedClaim& numbered_;
  const std::span<const std::uint32_t> faces_;
  RunControl& control_;
  Boxes boxes_;
};

/// Returns the max number of times that a face is divided into four.
int max_depth(std::size_t folded) {
  constexpr std::size_t kFew = 64, kMany = 4096;
  return folded <= kFew ? 4 : folded <= kMany ? 2 : 1;
}

/// Returns the largest distance of places of a triangle, or `farthest` if no place is farther.
double farthest_place(const Corners3& triangle, const OutputDistance& distance, double known, int depth,
                      double farthest) {
  struct Piece {
    Corners3 corners;
    int depth;
  };
  /// Places that are farther by less than this factor are not searched.
  constexpr double kEnough = 1.25;
  std::vector<Piece> pieces{{triangle, depth}};
  while (!pieces.empty()) {
    const auto [corners, left] = pieces.back();
    pieces.pop_back();
    const auto& [a, b, c] = corners;
    const Vec3 centre = (1.0 / 3) * (a + b + c);
    const double here = distance.from(centre);
    farthest = std::max(farthest, here);
    const double radius = std::max({norm(a - centre), norm(b - centre), norm(c - centre)});
    if (left == 0 || here + radius <= kEnough * std::max(known, farthest)) continue;
    const Vec3 ab = 0.5 * (a + b), bc = 0.5 * (b + c), ca = 0.5 * (c + a);
    for (const Corners3& part : {Corners3{a, ab, ca}, Corners3{ab, b, bc}, Corners3{ca, bc, c}, Corners3{ab, bc, ca}})
      pieces.push_back({part, left - 1});
  }
  return farthest;
}

/// Measures the distance of such faces from the output's triangles of that patch. A region that a fold covers twice,
/// once from each side, counts neither in the patch's area nor for its boundary. Only this distance shows whether the
/// surface has lost that region.
/// Input:  `folded` - these faces of the input; `known` - a distance between input and output that is known already.
/// Output: the largest distance of a dropped vertex, and of places inside the faces. Faces are divided where they may
///         hold places that are farther than both `known` and the largest distance so far, but not without end: the
///         result may be too small by a 16th of the longest edge of a folded face, and by up to half of it if there are
///         many folded faces.
/// Cost:   O((n + f) log n) for n triangles of the output and f folded faces.
double farthest_of_folded(const NumberedClaim& numbered, std::size_t patch, std::span<const std::uint32_t> folded,
                          double known, RunControl& control) {
  if (folded.empty()) return 0;
  std::vector<VertexId> gone;
  StopCheck check(control);
  for (const std::uint32_t f : folded)
    for (const VertexId v : numbered.input.face(f)) {
      check();
      if (numbered.is_in_output[v.value] == 0) gone.push_back(v);
    }
  sort_unique(gone, control);

  const OutputDistance distance(numbered, patch, control);
  double farthest = 0;
  for (const VertexId v : gone) farthest = std::max(farthest, distance.from(numbered.points[v.value]));
  const int depth = max_depth(folded.size());
  for (const std::uint32_t f : folded) {
    const auto face = numbered.input.face(f);
    const auto corner = [&](std::size_t k) { return numbered.points[face[k].value]; };
    // The triangles of the fan cover the polygon, even where it is not convex.
    for (std::size_t k = 1; k + 1 < face.size(); ++k)
      farthest = farthest_place({corner(0), corner(k), corner(k + 1)}, distance, known, depth, farthest);
  }
  return farthest;
}

constexpr std::size_t kPatchesPerBlock = 256;
/// The smallest and largest height over the patch's plane.
struct Heights {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void add(double h) {
    low = std::min(low, h);
    high = std::max(high, h);
  }
  void add(const Heights& other) {
    low = std::min(low, other.low);
    high = std::max(high, other.high);
  }
};

/// The totals over some faces of one side of a patch.
struct FlatReading {
  Heights heights;
  Measures measures;
  double reach = 0;                   ///< largest coordinate relative to the frame's origin
  FaceId facing_away;                 ///< the first input face that points away and is higher than the tolerance
  std::vector<std::uint32_t> folded;  ///< all input faces that point away
  bool are_all_positive = true;       ///< all output triangles are positively oriented
  std::vector<FoundFault> faults;

  void add(const FlatReading& other) {
    heights.add(other.heights);
    measures.add(other.measures);
    reach = std::max(reach, other.reach);
    facing_away = std::min(facing_away, other.facing_away);  // an invalid face has the largest number
    folded.insert(folded.end(), other.folded.begin(), other.folded.end());
    are_all_positive = are_all_positive && other.are_all_positive;
    faults.insert(faults.end(), other.faults.begin(), other.faults.end());
  }
};

bool is_frame(const Frame& frame) {
  constexpr double kSmall = 1e-12;
  int exponent = 0;
  const auto is_unit = [](const Vec3& v) { return std::fabs(norm(v) - 1) <= kSmall; };
  return is_finite(frame.origin) && is_unit(frame.x_axis) && is_unit(frame.y_axis) && is_unit(frame.normal) &&
         norm(cross(frame.x_axis, frame.y_axis) - frame.normal) <= kSmall && std::isfinite(frame.scale) &&
         std::frexp(frame.scale, &exponent) == 0.5 && (frame.grid == kCoarseGrid || frame.grid == kFineGrid);
}

double longest_extent(std::span<const VertexId> face, const Points& points) {
  Box3 box;
  for (const VertexId v : face) box.add(points[v.value]);
  return box.diagonal();
}

class PatchCheck {
 public:
  PatchCheck(const NumberedClaim& numbered, const EdgeTable& input_edges, const Seams& seams, const Boundary& boundary,
             std::size_t patch, std::vector<std::uint8_t>& is_positive, std::vector<FoundFault>& faults,
             RunControl& control)
      : numbered_(numbered),
        input_edges_(input_edges),
        seams_(seams),
        boundary_(boundary),
        patch_(patch),
        frame_(numbered.frames[patch]),
        is_positive_(is_positive),
        faults_(faults),
        control_(control) {}

  /// Output: the distance between input and output, or a bound on it.
  double run(ShapeSums& sums) {
    if (input_faces().empty() && output_faces().empty()) return 0;
    if (input_faces().empty() || output_faces().empty()) {
      report(Fault::kNoFaces);
      return 0;
    }
    has_frame_ = is_frame(frame_);
    if (!has_frame_) report(Fault::kFrame);
    control_.check();
    input_ = read(input_faces(), [&](std::uint32_t f, FlatReading& reading) { read_input(f, reading); });
    output_ = read(output_faces(), [&](std::uint32_t f, FlatReading& reading) { read_output(f, reading); });
    faults_.insert(faults_.end(), output_.faults.begin(), output_.faults.end());
    reach_ = std::max(input_.reach, output_.reach);
    compare_areas();
    double deviation = check_deviation();
    // In a sliver beside a curve that was cut anew, a point may be off in height and along the plane at once.
    if (!boundary_.allowed.empty() && boundary_.allowed[patch_] > 0) deviation = std::hypot(deviation, height_bound_);
    sums.deviation = std::max(sums.deviation, deviation);
    add_volume(sums);
    return deviation;
  }

 private:
  std::span<const std::uint32_t> input_faces() const { return numbered_.input_by_patch[patch_]; }
  std::span<const std::uint32_t> output_faces() const { return numbered_.output_by_patch[patch_]; }

  void report(Fault fault, std::uint32_t element = 0) { faults_.push_back({PatchId(patch_), fault, element}); }

  /// Reads the faces of one side. A large patch is read in blocks.
  template <class ReadFace>
  FlatReading read(std::span<const std::uint32_t> faces, const ReadFace& read_face) {
    const auto read_block = [&](std::size_t begin, std::size_t end) {
      FlatReading reading;
      for (const std::uint32_t f : faces.subspan(begin, end - begin)) read_face(f, reading);
      return reading;
    };
    if (faces.size() <= kItemsPerBlock) return read_block(0, faces.size());
    FlatReading all;
    for (const FlatReading& block : map_blocks<FlatReading>(faces.size(), kItemsPerBlock, control_, read_block))
      all.add(block);
    return all;
  }

  double height(const Vec3& p) const { return dot(p - frame_.origin, frame_.normal); }

  /// Adds a face to heights and measures.
  /// Output: twice the area vector of the face.
  template <class PointOf>
  Vec3 add_face(std::span<const VertexId> face, const PointOf& point_of, FlatReading& reading) const {
    const Vec3 first = point_of(face[0]);
    Heights heights;
    double reach = 0, magnitude = 0;
    const auto add_point = [&](const Vec3& p) {
      heights.add(height(p));
      reach = std::max(reach, largest_coordinate(p - frame_.origin));
    };
    add_point(first);
    const Vec3 second = point_of(face[1]);
    add_point(second);
    Vec3 twice_area, previous = second - first;
    for (std::size_t i = 2; i < face.size(); ++i) {
      const Vec3 p = point_of(face[i]);
      add_point(p);
      const Vec3 next = p - first;
      twice_area += cross(previous, next);
      magnitude += (std::fabs(previous.x) + std::fabs(previous.y) + std::fabs(previous.z)) *
                   (std::fabs(next.x) + std::fabs(next.y) + std::fabs(next.z));
      previous = next;
    }
    reading.heights.add(heights);
    reading.reach = std::max(reading.reach, reach);
    Measures& measures = reading.measures;
    measures.magnitude += magnitude;
    measures.terms += face.size() - 2;
    measures.twice_area += twice_area;
    measures.twice_absolute_area += std::sqrt(norm_squared(twice_area));
    measures.volume += dot(first, twice_area) / 6;
    return twice_area;
  }

  void read_input(std::uint32_t f, FlatReading& reading) const {
    const auto face = numbered_.input.face(f);
    const Vec3 twice_area = add_face(
        face, [&](VertexId v) { return numbered_.points[v.value]; }, reading);
    if (!(dot(twice_area, frame_.normal) > 0)) {
      const double extent = longest_extent(face, numbered_.points);
      const bool is_high = extent > 0 && !numbered_.is_within_tolerance(norm(twice_area) / extent / 2, extent);
      if (is_high && !reading.facing_away.is_valid()) reading.facing_away = FaceId(f);
      reading.folded.push_back(f);
    }
  }

  void read_output(std::uint32_t f, FlatReading& reading) const {
    const auto report = [&](Fault fault) { reading.faults.push_back({PatchId(patch_), fault, f}); };
    const auto face = numbered_.output.face(f);
    const Vec3 twice_area = add_face(
        face, [&](VertexId v) { return numbered_.output_point(v); }, reading);
    // A new or moved vertex was rounded when it was made. That rounding depends on its coordinates, not on its distance
    // from the frame's origin.
    for (const VertexId v : face)
      if (is_made(v)) reading.reach = std::max(reading.reach, largest_coordinate(numbered_.output_point(v)));

    const Vec3 a = numbered_.output_point(face[0]), b = numbered_.output_point(face[1]),
               c = numbered_.output_point(face[2]);
    const double extent = std::sqrt(std::max({norm_squared(b - a), norm_squared(c - b), norm_squared(a - c)}));
    const double twice_size = std::sqrt(norm_squared(twice_area));
    if (!(twice_size > 1e-12 * extent * extent) && is_collinear(a, b, c) && !is_input_triangle(face))
      report(Fault::kZeroArea);
    // The triangle points away in space. For a triangle no higher than the tolerance, noise decides the direction, so
    // it is exempt.
    const bool is_away = !(dot(twice_area, frame_.normal) > 0) &&
                         !(extent > 0 && numbered_.is_within_tolerance(twice_size / extent, extent));
    const bool is_turned_over = !read_plane_coordinates(f, face, reading) || is_away;
    if (is_turned_over && !is_input_triangle(face)) report(Fault::kInverted);
  }

  /// Tests the stored coordinates of a face.
  /// Output: true if the corners turn counter-clockwise.
  bool read_plane_coordinates(std::uint32_t f, std::span<const VertexId> face, FlatReading& reading) const {
    if (!has_frame_) return true;  // there is nothing to compare with; the frame has been reported
    const Vec2* uv = &numbered_.corner_uv[3 * f];
    for (int i = 0; i < 3; ++i) {
      if (is_on_grid(uv[i], frame_.grid) && is_projection(uv[i], face[i])) continue;
      reading.faults.push_back({PatchId(patch_), Fault::kPlaneCoordinates, f});
      reading.are_all_positive = false;
      return true;
    }
    const bool is_positive = orientation(uv[0], uv[1], uv[2], frame_.grid) > 0;
    is_positive_[f] = is_positive ? 1 : 0;
    reading.are_all_positive = reading.are_all_positive && is_positive;
    return is_positive;
  }

  /// True if these are the vertex's plane coordinates. They may differ by half the grid, and by the rounding of two
  /// computations (the stage's and this one). Each consists of about four operations on numbers no larger than the
  /// sum of |d|'s coordinates. On the fine grid they may differ by a whole grid step, because the stage raises
  /// triangles of height 0 there. A new vertex may have been made in the plane; then the point in space was rounded.
  bool is_projection(Vec2 uv, VertexId v) const {
    const Vec3 p = numbered_.output_point(v);
    const Vec3 d = p - frame_.origin;
    double noise = 0x1p-49 * (std::fabs(d.x) + std::fabs(d.y) + std::fabs(d.z)) / frame_.scale;
    if (is_made(v)) noise += NumberedClaim::rounding(largest_coordinate(p)) / frame_.scale;
    const double allowed = (frame_.grid == kFineGrid ? frame_.grid : frame_.grid / 2) + noise;
    return std::fabs(uv.x - dot(d, frame_.x_axis) / frame_.scale) <= allowed &&
           std::fabs(uv.y - dot(d, frame_.y_axis) / frame_.scale) <= allowed;
  }

  bool is_made(VertexId v) const { return numbered_.is_new(v) || numbered_.is_moved(v); }

  bool is_input_triangle(std::span<const VertexId> face) const {
    return verification::is_input_triangle(numbered_, input_edges_, PatchId(patch_), face);
  }

  bool is_unchanged() const { return verification::is_unchanged(numbered_, input_edges_, PatchId(patch_), control_); }

  /// The area vector depends on the boundary alone (Stokes). So it may change by the slivers at the boundary, and by
  /// rounding.
  void compare_areas() {
    const double change = norm(output_.measures.twice_area - input_.measures.twice_area) / 2;
    if (!(change <= boundary_.slivers[patch_] * (1 + 1e-9) + input_.measures.rounding() + output_.measures.rounding()))
      report(Fault::kArea);
  }

  /// Returns the distance between input and output, or a bound on it.
  double check_deviation() {
    const double along_boundary = boundary_.deviation[patch_];
    height_bound_ =
        std::max({input_.heights.high - output_.heights.low, output_.heights.high - input_.heights.low, 0.0});
    if (!has_frame_) return along_boundary;
    const bool is_flat = numbered_.is_within_tolerance(height_bound_, reach_);
    if ((!is_flat || input_.facing_away.is_valid()) && is_unchanged()) {
      height_bound_ = 0;
      return 0;
    }
    if (input_.facing_away.is_valid()) report(Fault::kFacingAway, input_.facing_away.value);
    const double known = is_flat ? std::max(along_boundary, height_bound_) : along_boundary;
    const double of_folds = farthest_of_folded(numbered_, patch_, input_.folded, known, control_);
    if (!numbered_.is_within_tolerance(of_folds, reach_)) report(Fault::kDeviation);
    if (is_flat) return std::max({along_boundary, height_bound_, of_folds});
    const double measured = std::max(
        output_.are_all_positive ? largest_height_of_dropped(numbered_, patch_, seams_.input, control_) : height_bound_,
        bound_of_new_heights());
    if (!numbered_.is_within_tolerance(measured, reach_)) report(Fault::kDeviation);
    return std::max({along_boundary, std::min(measured, height_bound_), of_folds});
  }

  /// Returns the distance of new vertices inside the patch from the input, or a bound on it. New vertices on the
  /// boundary are on their chords, which have been compared with the input.
  double bound_of_new_heights() {
    double bound = 0;
    StopCheck check(control_);
    for (const std::uint32_t f : output_faces()) {
      check();
      for (const VertexId v : numbered_.output.face(f))
        if (numbered_.is_new(v) && !seams_.output.has(v)) {
          const double h = height(numbered_.points[v.value]);
          bound = std::max({bound, input_.heights.high - h, h - input_.heights.low});
        }
    }
    if (numbered_.is_within_tolerance(bound, reach_)) return bound;
    return std::min(bound, largest_height_of_new(numbered_, patch_, seams_.output, control_));
  }

  /// Adds the change of volume and its bound. Input and output of the patch, and the slivers between their boundaries,
  /// enclose at most the area that they cover times the difference of their heights. The slivers of neighbours cancel
  /// if the surface is closed.
  void add_volume(ShapeSums& sums) const {
    sums.volume_change += output_.measures.volume - input_.measures.volume;
    sums.volume_bound += (std::max(input_.measures.twice_absolute_area, output_.measures.twice_absolute_area) / 2 +
                          boundary_.slivers[patch_]) *
                             (height_bound_ + 1e-15 * reach_) +
                         input_.measures.rounding() + output_.measures.rounding();
  }

  const NumberedClaim& numbered_;
  const EdgeTable& input_edges_;
  const Seams& seams_;
  const Boundary& boundary_;
  const std::size_t patch_;
  const Frame frame_;
  std::vector<std::uint8_t>& is_positive_;
  std::vector<FoundFault>& faults_;
  RunControl& control_;

  bool has_frame_ = false;
  FlatReading input_, output_;
  double reach_ = 0;  ///< the larger one of both sides
  double height_bound_ = 0;
};

}  // namespace

ShapeSums check_shapes(const NumberedClaim& numbered, const EdgeTable& input_edges, const Seams& seams,
                       const Boundary& boundary, std::vector<std::uint8_t>& is_positive, std::vector<double>& bounds,
                       FoundFaults& faults, RunControl& control) {
  struct Block {
    ShapeSums sums;
    std::vector<FoundFault> faults;
  };
  is_positive.assign(numbered.output.count(), 0);
  bounds.assign(numbered.patch_count(), 0);
  const auto check_patch = [&](std::size_t p, Block& block) {
    if (numbered.is_kept[p] != 0) {
      is_positive[numbered.output_by_patch[p][0]] = 1;
      return 0.0;
    }
    if (numbered.curved_surface(PatchId(p)) == nullptr)
      return PatchCheck(numbered, input_edges, seams, boundary, p, is_positive, block.faults, control).run(block.sums);
    return check_curved_patch(numbered, input_edges, boundary, PatchId(p), block.sums, block.faults, control);
  };
  const auto blocks =
      map_blocks<Block>(numbered.patch_count(), kPatchesPerBlock, control, [&](std::size_t begin, std::size_t end) {
        Block block;
        for (std::size_t p = begin; p < end; ++p) bounds[p] = check_patch(p, block);
        return block;
      });
  ShapeSums total;
  for (const Block& block : blocks) {
    faults.add(block.faults);
    total.deviation = std::max(total.deviation, block.sums.deviation);
    total.volume_change += block.sums.volume_change;
    total.volume_bound += block.sums.volume_bound;
  }
  return total;
}

}  // namespace remesh::verification
