#include "tests/mutate/judge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "tests/mutate/surface_model.h"
#include "tests/support/cgal_space.h"
#include "tests/support/random.h"
#include "tests/support/written_mesh.h"

namespace remesh::mutate {
namespace {

/// The number of points of each surface that are compared.
constexpr int kSamples = 40;
constexpr std::size_t kMaxFacesForIntersections = 1500;
constexpr std::size_t kMaxPairs = 1500;

/// True for diagnostics of an input that was mended or cannot be compared. The output is then the mended surface,
/// which is not available here.
bool is_mending(DiagnosticCode code) {
  switch (code) {
    case DiagnosticCode::kDuplicateVertex:
    case DiagnosticCode::kNonManifoldEdge:
    case DiagnosticCode::kNonManifoldVertex:
    case DiagnosticCode::kOpenBoundary:
    case DiagnosticCode::kSelfIntersection:
    case DiagnosticCode::kUnusedVertex:
    case DiagnosticCode::kAttributeDropped:
    case DiagnosticCode::kTrailingBytes:
    case DiagnosticCode::kCurvedSurface:
    case DiagnosticCode::kSmallDihedral:
    case DiagnosticCode::kRoundingCapped:
    case DiagnosticCode::kManyFaces:
    case DiagnosticCode::kRemovedDetail:
    case DiagnosticCode::kSmallDetail:
    case DiagnosticCode::kOutputAsText: return false;
    default: return true;
  }
}

bool has(const Report& report, DiagnosticCode code) {
  return std::any_of(report.diagnostics.begin(), report.diagnostics.end(),
                     [&](const auto& d) { return d.code == code; });
}

/// The bounds that the options ask for, in model units.
struct AskedFor {
  double min_angle_deg, max_edge, max_area;
};

AskedFor asked_for(const Options& options, double diagonal) {
  AskedFor bounds{options.min_angle_deg.value_or(25), HUGE_VAL, HUGE_VAL};
  if (options.max_radius_edge_ratio)
    bounds.min_angle_deg = std::asin(std::min(1.0, 0.5 / *options.max_radius_edge_ratio)) * 180 / std::numbers::pi;
  bounds.min_angle_deg = std::min(bounds.min_angle_deg, 33.0);
  if (options.max_edge_length) bounds.max_edge = *options.max_edge_length;
  if (options.max_edge_fraction) bounds.max_edge = *options.max_edge_fraction * diagonal;
  if (options.max_area) bounds.max_area = *options.max_area;
  return bounds;
}

class Judge {
 public:
  Judge(const PolygonMesh& input, const api::RemeshAnswer& answer, const WrittenMesh& written)
      : report_(answer.report),
        options_(answer.options.core),
        written_(written),
        scale_(scale_of(input)),
        input_(input, scale_, scale_.length(report_.plane_tolerance)),
        output_(moved_back(written, answer.report), scale_),
        is_clean_(std::none_of(report_.diagnostics.begin(), report_.diagnostics.end(),
                               [](const Diagnostic& d) { return is_mending(d.code); }) &&
                  options_.weld_tolerance == 0),
        random_(input.corners.size() * 7919 + written.faces.size()) {
    const double diagonal = input_.box().diagonal();
    double largest = 0;
    for (const Vec3& p : input_.originals())
      for (int axis = 0; axis < 3; ++axis) largest = std::max(largest, std::fabs(p[axis]));
    slack_ = (written.has_floats ? 1e-6 : 1e-9) * diagonal + scale_.length(8 * 0x1p-52 * largest);
    reach_ = scale_.length(proven_distance() + report_.output_rounding) + slack_;
    if (!is_clean_) reach_ += scale_.length(4 * report_.plane_tolerance + 2 * options_.weld_tolerance);
  }

  std::vector<Objection> objections() {
    check_counts();
    check_edges();
    check_zero_area();
    check_measures();
    check_distances();
    check_goals();
    check_intersections();
    return std::move(objections_);
  }

 private:
  /// Adds the origin to the coordinates, because they may be written relative to an origin near the part.
  static WrittenMesh moved_back(WrittenMesh mesh, const Report& report) {
    if (report.output_origin)
      for (Vec3& p : mesh.positions) p += *report.output_origin;
    return mesh;
  }

  /// Returns how far input and output are apart, as the report says. Details may have been removed.
  double proven_distance() const {
    if (!has(report_, DiagnosticCode::kRemovedDetail)) return report_.verified.deviation;
    return std::max(report_.distance_bound->output_to_input, report_.distance_bound->input_to_output);
  }

  template <class... Words>
  void object(std::string kind, const Words&... words) {
    std::ostringstream text;
    text.precision(17);
    (text << ... << words);
    text << (is_clean_ ? "" : " (the input was mended)");
    objections_.push_back({std::move(kind), text.str()});
  }

  void check_counts() {
    if (!report_.verified.all_true())
      object("not verified", report_.verified.failures.empty() ? "" : report_.verified.failures.front());
    if (written_.faces.size() != report_.output.faces)
      object("face count", written_.faces.size(), " faces are written, and the report says ", report_.output.faces);
    if (written_.has_own_vertices && written_.positions.size() != report_.output.vertices)
      object("vertex count", written_.positions.size(), " vertices are written, and the report says ",
             report_.output.vertices);
  }

  void check_edges() {
    // Faces that lie on each other may become one, whatever their sides.
    const bool is_rewound = has(report_, DiagnosticCode::kInconsistentWinding) ||
                            has(report_, DiagnosticCode::kDuplicateFace) || has(report_, DiagnosticCode::kSharedFaces);
    if (is_clean_ && input_.is_closed_manifold()) {
      if (!output_.is_closed_manifold()) object("opened", "the input is closed and manifold, and the output is not");
      // The number falls where the two sides of a flap or a closed part of its own went as details.
      const bool may_fall = has(report_, DiagnosticCode::kRemovedDetail) && output_.euler() < input_.euler();
      if (output_.euler() != input_.euler() && !may_fall)
        object("euler", "the Euler number was ", input_.euler(), " and is ", output_.euler());
    } else if (!is_rewound && input_.is_balanced() && !output_.is_balanced()) {
      object("opened", "every edge of the input has as many faces on one side as on the other; not so in the output");
    }
  }

  void check_zero_area() {
    const std::size_t count = output_.faces_without_area();
    if (count == 0) return;
    if (input_.faces_without_area() == 0 && is_clean_)
      object("zero area", count, " triangles without area, of which the input had none");
  }

  void check_measures() {
    const double area = output_.area(), before = input_.area();
    // The square of a coordinate may be larger than every double.
    if (!std::isfinite(std::ldexp(std::max(area, before), 2 * scale_.exponent))) return;
    const double said = std::ldexp(report_.output.area, -2 * scale_.exponent);
    // A spike that is far away is cut off, but the judge's units are those of the input with it.
    constexpr double kOwnRounding = 0x1p-100;
    const double rounding = 1e-6 * area + 4 * slack_ * output_.length_of_edges() + kOwnRounding;
    if (!(std::fabs(area - said) <= rounding))
      object("area told", "the area is ", std::ldexp(area, 2 * scale_.exponent), ", and the report says ",
             report_.output.area);
    if (!is_clean_) return;
    // The measures of a polygon that is not plane depend on how it is cut into triangles.
    const double thickness = greatest_thickness();
    if (std::fabs(area - before) > 4 * (reach_ + thickness) * input_.length_of_edges() + 1e-9 * before)
      object("area", "the area was ", std::ldexp(before, 2 * scale_.exponent), " and is ",
             std::ldexp(area, 2 * scale_.exponent));
    if (!input_.is_closed_manifold() || has(report_, DiagnosticCode::kInsideOut)) return;
    const double bound = std::ldexp(report_.volume_bound, -3 * scale_.exponent) +
                         (slack_ + thickness + scale_.length(report_.output_rounding)) * (area + before) +
                         input_.rounding_of_volume() + output_.rounding_of_volume();
    if (std::fabs(output_.volume() - input_.volume()) > bound)
      object("volume", "the volume was ", std::ldexp(input_.volume(), 3 * scale_.exponent), " and is ",
             std::ldexp(output_.volume(), 3 * scale_.exponent), "; the report explains ", report_.volume_bound);
  }

  double greatest_thickness() const {
    double greatest = 0;
    for (std::size_t f = 0; f < input_.face_count(); ++f) greatest = std::max(greatest, input_.thickness(f));
    return greatest;
  }

  void check_distances() {
    const Box3 before = input_.box(), after = output_.box();
    for (int axis = 0; axis < 3; ++axis) {
      if (after.min[axis] < before.min[axis] - reach_ || after.max[axis] > before.max[axis] + reach_)
        return object("bounding box", "the output leaves the input's bounding box");
    }
    double furthest = 0;
    // A face that closes a hole is not on the input.
    const int samples = has(report_, DiagnosticCode::kClosedHole) ? 0 : kSamples;
    for (int i = 0; i < samples && output_.face_count() > 0; ++i) {
      const std::size_t f = below(output_.face_count());
      const Vec3 p = i % 2 == 0 ? output_.positions()[output_.face(f)[0]] : output_.sample(f, random_);
      furthest = std::max(furthest, input_.distance(p));
    }
    // A polygon that is not plane may be cut in several ways, and the output has one of them.
    tell_distance("output to input", furthest, reach_ + greatest_thickness());
    furthest = 0;
    for (int i = 0; i < kSamples; ++i) {
      const std::size_t f = below(input_.face_count());
      // A face without area may be dropped, and a face that is not plane may be cut in several ways.
      if (input_.height(f) <= 2 * reach_ || input_.thickness(f) > reach_ || input_.has_spike(f, reach_)) continue;
      if (may_be_listed(f, DiagnosticCode::kDuplicateFace) || may_be_listed(f, DiagnosticCode::kDroppedPieces))
        continue;
      const Vec3 p = i % 2 == 0 ? input_.positions()[input_.face(f)[0]] : input_.sample(f, random_);
      furthest = std::max(furthest, output_.distance(p));
    }
    tell_distance("input to output", furthest, reach_);
  }

  /// Returns whether diagnostics of a code name a face of the input, or may mean it: no more than 100 faces are named.
  /// Both sides of a fin are dropped.
  bool may_be_listed(std::size_t face, DiagnosticCode code) const {
    return std::any_of(report_.diagnostics.begin(), report_.diagnostics.end(), [&](const Diagnostic& d) {
      const bool are_all_named = d.count <= d.elements.size();
      return d.code == code &&
             (!are_all_named || std::find(d.elements.begin(), d.elements.end(), face) != d.elements.end());
    });
  }

  void tell_distance(const char* direction, double furthest, double allowed) {
    if (!(furthest <= allowed))
      object("distance", direction, ": a point is ", std::ldexp(furthest, scale_.exponent),
             " away; the report's distance is ", proven_distance(), ", and ", std::ldexp(allowed, scale_.exponent),
             " is allowed");
  }

  /// Counts the faces that are beyond the bounds, which are made wider by a share. Lengths are measured from corner
  /// to corner: one vertex far away must not reduce the precision of all others.
  std::uint64_t count_beyond(const AskedFor& bounds, double part) const {
    std::uint64_t count = 0;
    for (std::size_t f = 0; f < output_.face_count(); ++f) {
      std::array<Vec3, 3> sides;
      double extent = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        sides[k] = output_.originals()[output_.face(f)[(k + 1) % 3]] - output_.originals()[output_.face(f)[k]];
        extent = std::max({extent, std::fabs(sides[k].x), std::fabs(sides[k].y), std::fabs(sides[k].z)});
      }
      int exponent = 0;
      std::frexp(extent, &exponent);
      double smallest = 180, longest = 0;
      for (Vec3& side : sides) {
        side = {std::ldexp(side.x, -exponent), std::ldexp(side.y, -exponent), std::ldexp(side.z, -exponent)};
        longest = std::max(longest, norm(side));
      }
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 &to = sides[k], from = -sides[(k + 2) % 3];
        smallest = std::min(smallest, std::atan2(norm(cross(to, from)), dot(to, from)) * 180 / std::numbers::pi);
      }
      const double area = norm(cross(sides[0], sides[1])) / 2;
      count += smallest < bounds.min_angle_deg * (1 - part) ||
               std::ldexp(longest, exponent) > bounds.max_edge * (1 + part) ||
               std::ldexp(area, 2 * exponent) > bounds.max_area * (1 + part);
    }
    return count;
  }

  void check_goals() {
    if (!options_.refine) return;
    constexpr double kRounding = 1e-6;
    AskedFor bounds = asked_for(options_, report_.input.bounding_box.diagonal());
    // A target chooses the largest edge.
    if (report_.largest_edge_for_target > 0) bounds.max_edge = report_.largest_edge_for_target;
    std::uint64_t listed = 0;
    for (const Unrefined& left : report_.unrefined) listed += left.count;
    const std::uint64_t sure = count_beyond(bounds, kRounding);
    if (sure > listed) object("not listed", sure, " faces are beyond the bounds, and ", listed, " are listed");
    // Faces beyond the sizes that gaps and neighbours ask for are listed too, but not counted here.
    const bool has_other_sizes = options_.proximity > 0 || options_.gradation.has_value();
    const std::uint64_t perhaps = count_beyond(bounds, -kRounding);
    if (!has_other_sizes && perhaps < listed)
      object("listed in vain", perhaps, " faces are beyond the bounds, and ", listed, " are listed");
  }

  /// Returns pairs of faces whose boxes meet. If there are many, only some are returned.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> near_pairs(const SurfaceModel& surface) {
    const auto box = [&](std::size_t f) {
      Box3 b;
      for (const std::uint32_t v : surface.face(f)) b.add({surface.originals()[v], surface.originals()[v]});
      return b;
    };
    std::vector<Box3> boxes;
    for (std::size_t f = 0; f < surface.face_count(); ++f) boxes.push_back(box(f));
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (std::uint32_t f = 0; f < boxes.size(); ++f) {
      for (std::uint32_t g = f + 1; g < boxes.size(); ++g) {
        bool do_meet = true;
        for (int axis = 0; axis < 3 && do_meet; ++axis)
          do_meet = boxes[f].min[axis] <= boxes[g].max[axis] && boxes[g].min[axis] <= boxes[f].max[axis];
        if (do_meet) pairs.emplace_back(f, g);
      }
    }
    while (pairs.size() > kMaxPairs) {
      std::swap(pairs[below(pairs.size())], pairs.back());
      pairs.pop_back();
    }
    return pairs;
  }

  /// Returns two faces that meet, among the pairs that were looked at.
  std::optional<std::pair<std::uint32_t, std::uint32_t>> first_intersection(const SurfaceModel& surface) {
    const CgalIntersection do_intersect(surface.originals());
    const auto triangle = [&](std::uint32_t f) {
      const auto& face = surface.face(f);
      return Triangle{VertexId(face[0]), VertexId(face[1]), VertexId(face[2])};
    };
    for (const auto& pair : near_pairs(surface))
      if (do_intersect(triangle(pair.first), triangle(pair.second))) return pair;
    return std::nullopt;
  }

  void check_intersections() {
    const bool is_small =
        input_.face_count() <= kMaxFacesForIntersections && output_.face_count() <= kMaxFacesForIntersections;
    if (!is_small || !is_clean_) return;
    // The input must have no intersections: by the report and, if it consists of triangles, by the sample.
    if (report_.input.intersecting_pairs != 0u || has(report_, DiagnosticCode::kSelfIntersection)) return;
    if (input_.is_of_triangles() && first_intersection(input_)) {
      object("intersection untold", "faces of the input intersect, and the report says that none do");
      return;
    }
    if (const auto pair = first_intersection(output_))
      object("intersection", "the faces ", pair->first, " and ", pair->second,
             " of the output intersect; none of the input do");
  }

  std::size_t below(std::size_t n) { return static_cast<std::size_t>(random_.bits() % n); }

  const Report& report_;
  const Options& options_;
  const WrittenMesh& written_;
  Scale scale_;
  SurfaceModel input_, output_;
  bool is_clean_;
  double slack_ = 0;  ///< scaled: the deviation that rounding and the format explain
  double reach_ = 0;  ///< scaled: how far apart the surfaces may be
  Random random_;
  std::vector<Objection> objections_;
};

}  // namespace

std::vector<Objection> judge(const PolygonMesh& input, const api::RemeshAnswer& answer) {
  try {
    RunControl control;
    std::string report;
    for (const std::string& piece : api::report_document(answer, control)) report += piece;
    test::expect_finite_json(report);
    const WrittenMesh written = test::read_written(answer.format, answer.body);
    return Judge(input, answer, written).objections();
  } catch (const std::runtime_error& error) {
    return {{"unreadable", error.what()}};
  }
}

}  // namespace remesh::mutate
