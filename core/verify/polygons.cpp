#include "core/verify/polygons.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace remesh::verification {
namespace {

constexpr std::size_t kCheckEvery = 4096;

/// What an outline encloses, from its corners alone.
struct OutlineMeasures {
  Vec3 twice_area;
  double magnitude = 0;  ///< what its rounding is in proportion to
  double length = 0;     ///< of the outline
};

OutlineMeasures measure(std::span<const Vec3> loop) {
  OutlineMeasures out;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3 a = loop[i] - loop[0], b = loop[i + 1 == loop.size() ? 0 : i + 1] - loop[0];
    out.twice_area += cross(a, b);
    out.magnitude += norm(a) * norm(b);
    out.length += norm(b - a);
  }
  return out;
}

bool is_flat(std::span<const Vec3> loop, const Vec3& normal, double tolerance) {
  return std::all_of(loop.begin(), loop.end(),
                     [&](const Vec3& p) { return std::fabs(dot(p - loop[0], normal)) <= tolerance; });
}

/// Takes away the corners at which the outline turns back over itself within the tolerance: a spike encloses nothing.
void cut_spikes(std::vector<Vec3>& loop, double tolerance, RunControl& control) {
  const auto is_tip = [&](const Vec3& before, const Vec3& tip, const Vec3& after) {
    const Vec3 a = before - tip, b = after - tip;
    const double to_a = norm(a), to_b = norm(b);
    if (std::min(to_a, to_b) <= tolerance) return true;
    return dot(a, b) > 0 && norm(cross(a, b)) <= tolerance * std::max(to_a, to_b);
  };
  std::size_t kept = 0;  // the corners before this one stay so far
  for (std::size_t i = 0; i < loop.size(); ++i) {
    if (i % kCheckEvery == 0) control.check();
    while (kept > 1 && is_tip(loop[kept - 2], loop[kept - 1], loop[i])) --kept;
    loop[kept++] = loop[i];
  }
  // The ends meet: what turns back there is taken away from both sides.
  std::size_t first = 0;
  for (bool is_cut = true; is_cut && kept - first > 2;) {
    is_cut = true;
    if (is_tip(loop[kept - 2], loop[kept - 1], loop[first]))
      --kept;
    else if (is_tip(loop[kept - 1], loop[first], loop[first + 1]))
      ++first;
    else
      is_cut = false;
  }
  loop.resize(kept);
  loop.erase(loop.begin(), loop.begin() + static_cast<std::ptrdiff_t>(first));
}

/// Whether a flat outline clearly neither crosses nor touches itself: no corner is within the tolerance of an edge that
/// does not end there, and no two edges cross.
bool is_clearly_simple(std::span<const Vec3> loop, const Vec3& normal, double tolerance, RunControl& control) {
  const std::size_t n = loop.size();
  if (n < 3) return false;
  const auto after = [&](std::size_t i) { return i + 1 == n ? 0 : i + 1; };
  // The answers are positive to the left of edge i.
  const auto side = [&](std::size_t i, const Vec3& p) {
    return dot(cross(loop[after(i)] - loop[i], p - loop[i]), normal);
  };
  const auto distance = [&](std::size_t i, const Vec3& p) {
    const Vec3 way = loop[after(i)] - loop[i];
    const double squared = norm_squared(way);
    const double share = squared > 0 ? std::clamp(dot(p - loop[i], way) / squared, 0.0, 1.0) : 0;
    return norm(p - loop[i] - share * way);
  };
  const auto are_apart = [](double a, double b) { return (a < 0) != (b < 0); };
  for (std::size_t i = 0; i < n; ++i) {
    control.check();
    for (std::size_t j = 0; j < n; ++j) {
      if (j == i || j == after(i)) continue;
      if (!(distance(i, loop[j]) > tolerance)) return false;
      if (j > i && after(j) != i && are_apart(side(i, loop[j]), side(i, loop[after(j)])) &&
          are_apart(side(j, loop[i]), side(j, loop[after(i)])))
        return false;
    }
  }
  return true;
}

class PolygonCheck {
 public:
  PolygonCheck(const Claim& claim, const Model& model, Findings& findings, RunControl& control)
      : claim_(claim), model_(model), findings_(findings), control_(control) {
    // Mending moves corners twice at most, welding once.
    moved_ = 2 * model.tolerance + model.scale * claim.weld_tolerance;
  }

  void run() {
    const Surface& surface = claim_.surface;
    const std::size_t faces = surface.face_count();
    std::size_t next_check = 0;
    for (std::size_t begin = 0, end = 0; begin < faces; begin = end) {
      if (begin >= next_check) {
        control_.check();
        next_check = begin + kCheckEvery;
      }
      const FaceId source = surface.face_source[FaceId(begin)];
      for (end = begin + 1; end < faces && surface.face_source[FaceId(end)] == source;) ++end;
      if (source.value < claim_.input->face_count() && claim_.input->face(source).size() > 3) check(source, begin, end);
    }
  }

 private:
  /// Holds the surface's faces [begin, end) against the polygon that they came of.
  void check(FaceId source, std::size_t begin, std::size_t end) {
    loop_.clear();
    for (const VertexId v : claim_.input->face(source)) loop_.push_back(model_.scale * claim_.input->positions[v]);
    const OutlineMeasures outline = measure(loop_);
    Vec3 twice_sum;
    double twice_covered = 0, magnitude = outline.magnitude;
    for (std::size_t f = begin; f < end; ++f) {
      face_.clear();
      for (const VertexId v : model_.input.face(f)) face_.push_back(model_.points[v.value]);
      const OutlineMeasures of_face = measure(face_);
      twice_sum += of_face.twice_area;
      twice_covered += norm(of_face.twice_area);
      magnitude += of_face.magnitude;
    }
    const double twice_area = norm(outline.twice_area);
    const double allowed = 2 * moved_ * outline.length + 0x1p-45 * magnitude;
    const bool is_area_kept = std::fabs(norm(twice_sum) - twice_area) <= allowed;
    if ((is_area_kept && twice_covered <= twice_area + allowed) || !(twice_area > 0)) return;
    const Vec3 normal = (1 / twice_area) * outline.twice_area;
    const double reach = moved_ + 0x1p-45 * outline.length;
    // Triangles of a bent polygon may face in many directions, but their sum is its area.
    if (is_area_kept && !is_flat(loop_, normal, reach)) return;
    const Vec3 origin = loop_[0];
    for (Vec3& p : loop_) p = p - dot(p - origin, normal) * normal;
    cut_spikes(loop_, reach, control_);
    if (loop_.size() <= kMaxCorners && is_clearly_simple(loop_, normal, reach, control_)) report(begin, source);
  }

  void report(std::size_t face, FaceId source) {
    findings_.add(claim_.surface_patch[face], Fault::kPolygon, source.value);
  }

  static constexpr std::size_t kMaxCorners = 4096;

  const Claim& claim_;
  const Model& model_;
  Findings& findings_;
  RunControl& control_;
  double moved_;  ///< how far a corner may be from where it was read
  std::vector<Vec3> loop_, face_;
};

}  // namespace

void check_polygons(const Claim& claim, const Model& model, Findings& findings, RunControl& control) {
  // A mesh of triangles has none.
  if (claim.input == nullptr || claim.input->corners.size() == 3 * claim.input->face_count()) return;
  PolygonCheck(claim, model, findings, control).run();
}

}  // namespace remesh::verification
