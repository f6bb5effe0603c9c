#include "core/verify/patch_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/blocks.h"
#include "core/verify/exact.h"
#include "core/verify/height_measure.h"

namespace remesh::verification {
namespace {

constexpr std::size_t kPatchesPerBlock = 256;
constexpr std::size_t kCheckEvery = 8192;

/// Smallest and largest height over the patch's plane.
struct Heights {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void add(double h) {
    low = std::min(low, h);
    high = std::max(high, h);
  }
};

/// Area vector and enclosed volume of a set of faces, with what bounds their rounding.
struct Measures {
  Vec3 twice_area;
  double twice_absolute_area = 0;
  double volume = 0;
  double magnitude = 0;  ///< sum of the products that went into twice_area
  std::size_t terms = 0;

  /// Rounding of `twice_area`: each term by a few units in its last place, each addition by one in that of the sum.
  double rounding() const { return static_cast<double>(terms + 8) * 0x1p-52 * magnitude; }
};

bool is_frame(const Frame& frame) {
  constexpr double kSmall = 1e-12;
  int exponent = 0;
  const auto is_unit = [](const Vec3& v) { return std::fabs(norm(v) - 1) <= kSmall; };
  return is_finite(frame.origin) && is_unit(frame.x_axis) && is_unit(frame.y_axis) && is_unit(frame.normal) &&
         norm(cross(frame.x_axis, frame.y_axis) - frame.normal) <= kSmall && std::isfinite(frame.scale) &&
         std::frexp(frame.scale, &exponent) == 0.5 && (frame.grid == kCoarseGrid || frame.grid == kFineGrid);
}

double longest_extent(std::span<const VertexId> face, const std::vector<Vec3>& points) {
  Box3 box;
  for (const VertexId v : face) box.add(points[v.value]);
  return box.diagonal();
}

class PatchCheck {
 public:
  PatchCheck(const Model& model, const EdgeTable& input_edges, const Seams& seams, const Boundary& boundary,
             std::size_t patch, std::vector<std::uint8_t>& is_positive, std::vector<Finding>& findings,
             RunControl& control)
      : model_(model),
        input_edges_(input_edges),
        seams_(seams),
        boundary_(boundary),
        patch_(patch),
        frame_(model.frames[patch]),
        input_faces_(model.input_by_patch[patch]),
        output_faces_(model.output_by_patch[patch]),
        is_positive_(is_positive),
        findings_(findings),
        control_(control) {}

  void run(ShapeSums& sums) {
    if (input_faces_.empty() && output_faces_.empty()) return;
    if (input_faces_.empty() || output_faces_.empty()) return report(Fault::kNoFaces);
    has_frame_ = is_frame(frame_);
    if (!has_frame_) report(Fault::kFrame);
    for (const std::uint32_t f : input_faces_) read_input(f);
    for (const std::uint32_t f : output_faces_) read_output(f);
    compare_areas();
    const double deviation = check_deviation();
    sums.deviation = std::max(sums.deviation, deviation);
    add_volume(sums);
  }

 private:
  void report(Fault fault, std::uint32_t element = 0) { findings_.push_back({PatchId(patch_), fault, element}); }
  void tick() {
    if (++steps_ % kCheckEvery == 0) control_.check();
  }

  double height(VertexId v) {
    const Vec3 d = model_.points[v.value] - frame_.origin;
    reach_ = std::max(reach_, largest_coordinate(d));
    // A new vertex was rounded when it was made, by its coordinates, not by its distance from the frame's origin.
    if (model_.is_new(v)) reach_ = std::max(reach_, largest_coordinate(model_.points[v.value]));
    return dot(d, frame_.normal);
  }

  /// Adds a face to the measures; returns twice its area vector.
  Vec3 add_face(std::span<const VertexId> face, Measures& measures) {
    const Vec3& first = model_.points[face[0].value];
    Vec3 twice_area, previous = model_.points[face[1].value] - first;
    for (std::size_t i = 2; i < face.size(); ++i) {
      const Vec3 next = model_.points[face[i].value] - first;
      twice_area += cross(previous, next);
      measures.magnitude += (std::fabs(previous.x) + std::fabs(previous.y) + std::fabs(previous.z)) *
                            (std::fabs(next.x) + std::fabs(next.y) + std::fabs(next.z));
      previous = next;
    }
    measures.terms += face.size() - 2;
    measures.twice_area += twice_area;
    measures.twice_absolute_area += std::sqrt(norm_squared(twice_area));
    measures.volume += dot(first, twice_area) / 6;
    return twice_area;
  }

  void read_input(std::uint32_t f) {
    tick();
    const auto face = model_.input.face(f);
    for (const VertexId v : face) input_heights_.add(height(v));
    const Vec3 twice_area = add_face(face, input_);
    if (!(dot(twice_area, frame_.normal) > 0)) {
      const double extent = longest_extent(face, model_.points);
      const bool is_high = extent > 0 && !model_.is_within_tolerance(norm(twice_area) / extent / 2, extent);
      if (is_high && !facing_away_.is_valid()) facing_away_ = FaceId(f);
    }
  }

  void read_output(std::uint32_t f) {
    tick();
    const auto face = model_.output.face(f);
    for (const VertexId v : face) output_heights_.add(height(v));
    const Vec3 twice_area = add_face(face, output_);

    const Vec3 &a = model_.points[face[0].value], &b = model_.points[face[1].value], &c = model_.points[face[2].value];
    const double extent = std::sqrt(std::max({norm_squared(b - a), norm_squared(c - b), norm_squared(a - c)}));
    const double twice_size = std::sqrt(norm_squared(twice_area));
    if (!(twice_size > 1e-12 * extent * extent) && is_collinear(a, b, c) && !is_input_triangle(face))
      report(Fault::kZeroArea, f);
    // Turned over in space; but of a triangle no higher than the tolerance noise decides where it looks.
    const bool is_away = !(dot(twice_area, frame_.normal) > 0) &&
                         !(extent > 0 && model_.is_within_tolerance(twice_size / extent, extent));
    const bool is_turned_over = !read_plane_coordinates(f, face) || is_away;
    if (is_turned_over && !is_input_triangle(face)) report(Fault::kInverted, f);
  }

  /// Tests the stored coordinates of a face; returns whether they turn counter-clockwise.
  bool read_plane_coordinates(std::uint32_t f, std::span<const VertexId> face) {
    if (!has_frame_) return true;  // nothing to go by; the frame has been reported
    const Vec2* uv = &model_.corner_uv[3 * f];
    for (int i = 0; i < 3; ++i) {
      if (is_on_grid(uv[i], frame_.grid) && is_projection(uv[i], face[i])) continue;
      report(Fault::kPlaneCoordinates, f);
      are_all_positive_ = false;
      return true;
    }
    const bool is_positive = orientation(uv[0], uv[1], uv[2], frame_.grid) > 0;
    is_positive_[f] = is_positive ? 1 : 0;
    are_all_positive_ = are_all_positive_ && is_positive;
    return is_positive;
  }

  /// Are these the vertex's plane coordinates? They may be off by half the grid, and by the rounding of two
  /// computations (the stage's and this one), each of some four operations on numbers no larger than the sum of |d|'s
  /// coordinates. A new vertex may have been made in the plane: then it is the one in space that was rounded.
  bool is_projection(Vec2 uv, VertexId v) const {
    const Vec3& p = model_.points[v.value];
    const Vec3 d = p - frame_.origin;
    double noise = 0x1p-49 * (std::fabs(d.x) + std::fabs(d.y) + std::fabs(d.z)) / frame_.scale;
    if (model_.is_new(v)) noise += Model::rounding(largest_coordinate(p)) / frame_.scale;
    const double allowed = frame_.grid / 2 + noise;
    return std::fabs(uv.x - dot(d, frame_.x_axis) / frame_.scale) <= allowed &&
           std::fabs(uv.y - dot(d, frame_.y_axis) / frame_.scale) <= allowed;
  }

  /// Has the input this triangle, in this patch and the same way round?
  bool is_input_triangle(std::span<const VertexId> face) const {
    if (face[0].value >= model_.surface_vertex_count || face[1].value >= model_.surface_vertex_count) return false;
    for (const Use& use : input_edges_.find(face[0], face[1])) {
      if (use.patch().value != patch_ || use.is_forward() != (face[0] < face[1])) continue;
      const auto after =
          std::upper_bound(model_.input.face_begin.begin(), model_.input.face_begin.end(), use.half_edge);
      const auto same = model_.input.face(static_cast<std::size_t>(after - model_.input.face_begin.begin() - 1));
      if (same.size() == 3 && std::find(same.begin(), same.end(), face[2]) != same.end()) return true;
    }
    return false;
  }

  bool is_unchanged() const {
    if (input_faces_.size() != output_faces_.size()) return false;
    return std::all_of(output_faces_.begin(), output_faces_.end(),
                       [&](std::uint32_t f) { return is_input_triangle(model_.output.face(f)); });
  }

  /// The area vector depends on the boundary alone (Stokes), so it may change by the slivers there, and by rounding.
  void compare_areas() {
    const double change = norm(output_.twice_area - input_.twice_area) / 2;
    if (!(change <= boundary_.slivers[patch_] * (1 + 1e-9) + input_.rounding() + output_.rounding()))
      report(Fault::kArea);
  }

  /// Returns the distance between input and output, or a bound of it.
  double check_deviation() {
    const double along_boundary = boundary_.deviation[patch_];
    height_bound_ =
        std::max({input_heights_.high - output_heights_.low, output_heights_.high - input_heights_.low, 0.0});
    if (!has_frame_) return along_boundary;
    const bool is_flat = model_.is_within_tolerance(height_bound_, reach_);
    if ((!is_flat || facing_away_.is_valid()) && is_unchanged()) {
      height_bound_ = 0;
      return 0;
    }
    if (facing_away_.is_valid()) report(Fault::kFacingAway, facing_away_.value);
    if (is_flat) return std::max(along_boundary, height_bound_);
    const double measured =
        std::max(are_all_positive_ ? largest_height_of_dropped(model_, patch_, seams_.input, control_) : height_bound_,
                 bound_of_new_heights());
    if (!model_.is_within_tolerance(measured, reach_)) report(Fault::kDeviation);
    return std::max(along_boundary, std::min(measured, height_bound_));
  }

  /// How far new vertices inside the patch are from the input, or a bound of it. Those on the boundary are on their
  /// chords, and these have been held against the input.
  double bound_of_new_heights() {
    double bound = 0;
    for (const std::uint32_t f : output_faces_)
      for (const VertexId v : model_.output.face(f))
        if (model_.is_new(v) && !seams_.output.has(v)) {
          const double h = height(v);
          bound = std::max({bound, input_heights_.high - h, h - input_heights_.low});
        }
    if (model_.is_within_tolerance(bound, reach_)) return bound;
    return std::min(bound, largest_height_of_new(model_, patch_, seams_.output, control_));
  }

  /// Input and output of the patch, and the slivers between their boundaries, enclose no more than the area that they
  /// cover times the difference of their heights; the slivers of neighbours cancel where the surface is closed.
  void add_volume(ShapeSums& sums) const {
    sums.volume_change += output_.volume - input_.volume;
    sums.volume_bound +=
        (std::max(input_.twice_absolute_area, output_.twice_absolute_area) / 2 + boundary_.slivers[patch_]) *
            (height_bound_ + 1e-15 * reach_) +
        input_.rounding() + output_.rounding();
  }

  const Model& model_;
  const EdgeTable& input_edges_;
  const Seams& seams_;
  const Boundary& boundary_;
  const std::size_t patch_;
  const Frame& frame_;
  const std::span<const std::uint32_t> input_faces_, output_faces_;
  std::vector<std::uint8_t>& is_positive_;
  std::vector<Finding>& findings_;
  RunControl& control_;

  bool has_frame_ = false;
  bool are_all_positive_ = true;
  std::size_t steps_ = 0;
  double reach_ = 0;  ///< largest coordinate relative to the frame's origin
  Heights input_heights_, output_heights_;
  Measures input_, output_;
  FaceId facing_away_;
  double height_bound_ = 0;
};

}  // namespace

ShapeSums check_shapes(const Model& model, const EdgeTable& input_edges, const Seams& seams, const Boundary& boundary,
                       std::vector<std::uint8_t>& is_positive, Findings& findings, RunControl& control) {
  struct Block {
    ShapeSums sums;
    std::vector<Finding> findings;
  };
  is_positive.assign(model.output.count(), 0);
  const auto blocks =
      map_blocks<Block>(model.patch_count(), kPatchesPerBlock, control, [&](std::size_t begin, std::size_t end) {
        Block block;
        for (std::size_t p = begin; p < end; ++p)
          PatchCheck(model, input_edges, seams, boundary, p, is_positive, block.findings, control).run(block.sums);
        return block;
      });
  ShapeSums total;
  for (const Block& block : blocks) {
    findings.add(block.findings);
    total.deviation = std::max(total.deviation, block.sums.deviation);
    total.volume_change += block.sums.volume_change;
    total.volume_bound += block.sums.volume_bound;
  }
  return total;
}

}  // namespace remesh::verification
