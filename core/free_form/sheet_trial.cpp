#include "core/free_form/sheet_trial.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/exact/predicates.h"

namespace remesh {
namespace {

/// New triangles turn by less than the angle with this cosine: 70 degrees.
constexpr double kMaxTurn = 0.342;
/// In a plane, where triangles are made anew later, below the one with this cosine: 1 degree.
constexpr double kNeedleInPlane = 0.99985;

Vec3 area_vector(const Corners3& t) { return cross(t[1] - t[0], t[2] - t[0]); }

}  // namespace

double max_cosine(const Corners3& t) {
  const double a = norm_squared(t[2] - t[1]), b = norm_squared(t[0] - t[2]), c = norm_squared(t[1] - t[0]);
  // The smallest angle is that across the shortest side.
  const double shortest = std::min({a, b, c}), sum = a + b + c - 2 * shortest;
  const double product = shortest == a ? b * c : shortest == b ? a * c : a * b;
  return product > 0 ? sum / (2 * std::sqrt(product)) : 1;
}

double triangles_needed(const IdVector<VertexId, Vec3>& positions, const IdVector<FaceId, Triangle>& faces,
                        double min_angle_deg, const RunControl& control) {
  const double tangent = std::tan(min_angle_deg * std::numbers::pi / 180);
  StopCheck check(control);
  double sum = 0;
  for (const Triangle& t : faces) {
    check();
    if (!t[0].is_valid()) continue;
    const double cosine = max_cosine({positions[t[0]], positions[t[1]], positions[t[2]]});
    // The smallest angle of a triangle is at most 60 degrees, and may be none at all.
    const double squared_sine = std::clamp(1 - cosine * cosine, 0x1p-40, 0.75);
    sum += std::max(1.0, tangent * std::fabs(cosine) / std::sqrt(squared_sine));
  }
  return sum;
}

void SheetTrial::clear() {
  faces_.clear();
  changed_.clear();
  in_plane_.clear();
  found_.clear();
  cosine_before_ = -1;
}

void SheetTrial::add(FaceId f) {
  faces_.push_back(f);
  cosine_before_ = std::max(cosine_before_, remesh::max_cosine(sheet_.corners_of(f)));
}

void SheetTrial::add_changed(FaceId f, const Corners3& corners) {
  const Corners3 before = sheet_.corners_of(f);
  if (sheet_.is_of_plane[f] != 0) {
    const Vec3 area = area_vector(before);
    int axis = std::fabs(area.y) > std::fabs(area.x) ? 1 : 0;
    if (std::fabs(area.z) > std::fabs(area[axis])) axis = 2;
    in_plane_.push_back({corners, axis, area[axis] < 0, remesh::max_cosine(before)});
    return;
  }
  // The normal of a needle says little about the surface.
  const bool is_needle = remesh::max_cosine(before) > kNeedle;
  changed_.push_back({f, corners, is_needle ? Vec3() : area_vector(before), {}, {}, {}, FaceId(), HUGE_VAL});
  add(f);
}

void SheetTrial::gather() {
  for (const FaceId f : faces_)
    for (std::uint32_t w = witnesses_.of_face[f]; w != kNone; w = witnesses_.all[w].next) {
      check_();
      const SheetWitnesses::Witness& witness = witnesses_.all[w];
      found_.push_back({witness.place, w, 0, witness.face, input_.share(witness.face)});
    }
}

/// Returns whether a triangle is seen from the side from which it was seen before, and is no needle that was none. So
/// the triangles of a plane never overlap.
bool SheetTrial::stays_in_plane(const InPlane& triangle) {
  const auto seen = [&](const Vec3& p) { return Vec2{p[(triangle.axis + 1) % 3], p[(triangle.axis + 2) % 3]}; };
  const int side = orient2d(seen(triangle.corners[0]), seen(triangle.corners[1]), seen(triangle.corners[2]));
  return side == (triangle.is_turned ? -1 : 1) &&
         remesh::max_cosine(triangle.corners) <= std::max(kNeedleInPlane, triangle.cosine_before);
}

bool SheetTrial::has_good_shapes(const Vec3& apex, double max_cosine) {
  if (changed_.empty()) return false;
  for (InPlane& triangle : in_plane_) {
    triangle.corners[0] = apex;
    if (!stays_in_plane(triangle)) return false;
  }
  cosine_after_ = -1;
  for (Changed& changed : changed_) {
    changed.corners[0] = apex;
    const double cosine = remesh::max_cosine(changed.corners);
    if (!(cosine <= max_cosine)) return false;
    cosine_after_ = std::max(cosine_after_, cosine);
  }
  Vec3 sum;
  for (Changed& changed : changed_) {
    const Vec3 first = changed.corners[1] - apex, second = changed.corners[2] - apex;
    const Vec3 area = cross(first, second);
    const double squared = norm_squared(area);
    if (!(squared > 0)) return false;
    changed.normal = (1 / std::sqrt(squared)) * area;
    // (A normal before of a needle is null.)
    const double cosine = dot(changed.normal, changed.normal_before), before = norm_squared(changed.normal_before);
    if (before > 0 && (cosine <= 0 || cosine * cosine < kMaxTurn * kMaxTurn * before)) return false;
    changed.second = (1 / squared) * cross(second, area);
    changed.third = (1 / squared) * cross(area, first);
    sum += area;
  }
  direction_ = normalized(sum);
  // A needle tells nothing of its own, but must not look back at the others.
  return std::all_of(changed_.begin(), changed_.end(), [&](const Changed& changed) {
    return norm_squared(changed.normal_before) > 0 || dot(changed.normal, direction_) > 0;
  });
}

void SheetTrial::bound_step(double distance, double share, double tolerance) {
  constexpr double kTooLittle = 1e-3;
  if (share < kTooLittle) {
    if (std::fabs(distance) > tolerance) max_step_ = -HUGE_VAL;
    return;
  }
  min_step_ = std::max(min_step_, (distance - tolerance) / share);
  max_step_ = std::min(max_step_, (distance + tolerance) / share);
}

/// Finds the new triangle above or below a witness, or else the nearest one.
/// Input: the search begins with the changed triangle `first`.
bool SheetTrial::find(Found& witness, std::size_t first, double tolerance) {
  double best = HUGE_VAL, best_share = 0;
  for (std::size_t i = 0, at = first; i < changed_.size(); ++i, at = at + 1 == changed_.size() ? 0 : at + 1) {
    const Changed& changed = changed_[at];
    const Vec3 way = witness.place - changed.corners[0];
    const double second = dot(way, changed.second), third = dot(way, changed.third);
    if (second < 0 || third < 0 || second + third > 1) continue;
    const double distance = dot(way, changed.normal);
    if (std::fabs(distance) >= std::fabs(best)) continue;
    best = distance;
    best_share = (1 - second - third) * dot(changed.normal, direction_);
    witness.changed = static_cast<std::uint32_t>(at);
    if (std::fabs(distance) <= tolerance) break;
  }
  if (std::fabs(best) < 8 * tolerance) bound_step(best, best_share, tolerance);
  if (std::fabs(best) <= tolerance) return true;
  double nearest = HUGE_VAL;
  for (std::size_t at = 0; at < changed_.size(); ++at) {
    const double squared = norm_squared(nearest_on_triangle(witness.place, changed_[at].corners) - witness.place);
    if (squared >= nearest) continue;
    nearest = squared;
    witness.changed = static_cast<std::uint32_t>(at);
    if (nearest <= tolerance * tolerance) break;
  }
  return nearest <= tolerance * tolerance;
}

bool SheetTrial::finds_witnesses(double tolerance) {
  min_step_ = -HUGE_VAL;
  max_step_ = HUGE_VAL;
  for (Changed& changed : changed_) {
    changed.start = FaceId();
    changed.start_distance = HUGE_VAL;
  }
  if (found_.empty()) gather();
  steps_ += found_.size();
  bool are_near = true;
  std::size_t last = 0;
  for (Found& witness : found_) {
    check_();
    if (!find(witness, last, tolerance * witness.share)) are_near = false;
    if (!are_near && !has_better_step()) return false;
    last = witness.changed;
    Changed& changed = changed_[last];
    const Vec3 centre = (1.0 / 3) * (changed.corners[0] + changed.corners[1] + changed.corners[2]);
    const double squared = norm_squared(witness.place - centre);
    if (squared >= changed.start_distance) continue;
    changed.start_distance = squared;
    changed.start = witness.face;
  }
  return are_near;
}

bool SheetTrial::is_near_input(double tolerance) const {
  FaceId any;
  for (const Changed& changed : changed_)
    if (changed.start.is_valid()) any = changed.start;
  if (!any.is_valid()) {
    if (found_.empty()) return false;
    any = found_.front().face;
  }
  const auto is_near = [&](const Vec3& p, FaceId start) { return input_.near_face(p, start, tolerance).is_valid(); };
  const Vec3& apex = changed_.front().corners[0];
  if (!is_near(apex, any)) return false;
  for (const Changed& changed : changed_) {
    const FaceId start = changed.start.is_valid() ? changed.start : any;
    const Vec3 &p = changed.corners[1], &q = changed.corners[2];
    if (!is_near((1.0 / 3) * (apex + p + q), start) || !is_near(0.5 * (apex + p), start)) return false;
  }
  constexpr int kRows = 3;
  for (const Changed& changed : changed_) {
    const FaceId start = changed.start.is_valid() ? changed.start : any;
    const Vec3 &p = changed.corners[1], &q = changed.corners[2];
    for (int i = 0; i < kRows; ++i)
      for (int j = i == 0 ? 1 : 0; j < kRows && i + j <= kRows; ++j) {
        const Vec3 sum =
            static_cast<double>(kRows - i - j) * apex + static_cast<double>(i) * p + static_cast<double>(j) * q;
        if (!is_near((1.0 / kRows) * sum, start)) return false;
      }
  }
  return true;
}

void SheetTrial::move_witnesses(SheetWitnesses& witnesses) const {
  for (const Changed& changed : changed_) witnesses.of_face[changed.face] = kNone;
  for (const Found& found : found_) {
    std::uint32_t& first = witnesses.of_face[changed_[found.changed].face];
    witnesses.all[found.witness].next = first;
    first = found.witness;
  }
}

}  // namespace remesh
