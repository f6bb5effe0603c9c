/// Points and vectors in the plane and in space, in doubles.
#pragma once

#include <algorithm>
#include <cmath>
#include <compare>

namespace remesh {

struct Vec2 {
  double x = 0;
  double y = 0;

  /// Compares lexicographically, x first. The sweep that triangulates a patch (lexicographic_triangulation.h) visits
  /// the points in this order. The same order decides between points of a patch wherever nothing else does.
  friend constexpr auto operator<=>(const Vec2&, const Vec2&) = default;
  friend constexpr Vec2 operator+(Vec2 a, Vec2 b) { return {a.x + b.x, a.y + b.y}; }
  friend constexpr Vec2 operator-(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }
  friend constexpr Vec2 operator*(double s, Vec2 a) { return {s * a.x, s * a.y}; }
};

struct Vec3 {
  double x = 0;
  double y = 0;
  double z = 0;

  /// Compares lexicographically. This order breaks ties between points in space.
  friend constexpr auto operator<=>(const Vec3&, const Vec3&) = default;
  friend constexpr Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr Vec3 operator*(double s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
  Vec3& operator+=(const Vec3& b) { return *this = *this + b; }

  double& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
  double operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
};

constexpr double dot(Vec2 a, Vec2 b) { return a.x * b.x + a.y * b.y; }
constexpr double cross(Vec2 a, Vec2 b) { return a.x * b.y - a.y * b.x; }
constexpr double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

constexpr double norm_squared(const Vec3& a) { return dot(a, a); }
/// The length. The squares neither overflow nor underflow.
inline double norm(const Vec3& a) {
  const double squared = norm_squared(a);
  // The squares are almost always far from both limits, and this is several times as fast.
  if (squared > 0x1p-900 && squared < 0x1p1000) return std::sqrt(squared);
  return std::hypot(a.x, a.y, a.z);
}
inline double norm(Vec2 a) { return std::hypot(a.x, a.y); }
/// The unit vector in the direction of `a`. The null vector stays null.
inline Vec3 normalized(const Vec3& a) {
  const double n = norm(a);
  return n > 0 ? Vec3{a.x / n, a.y / n, a.z / n} : Vec3{};
}
/// Returns a unit vector across an axis. It depends on the direction of the axis alone.
inline Vec3 unit_across(const Vec3& axis) {
  const double x = std::fabs(axis.x), y = std::fabs(axis.y), z = std::fabs(axis.z);
  const Vec3 farthest = x <= y && x <= z ? Vec3{1, 0, 0} : y <= z ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  return normalized(cross(axis, farthest));
}
inline bool is_finite(const Vec3& a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }

/// An axis-aligned box. It is empty until a point or box is added.
struct Box3 {
  Vec3 min{HUGE_VAL, HUGE_VAL, HUGE_VAL};
  Vec3 max{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};

  /// A coordinate that is not a number (NaN) does not change the box.
  void add(const Vec3& p) { add({p, p}); }
  void add(const Box3& other) {
    min = {std::min(min.x, other.min.x), std::min(min.y, other.min.y), std::min(min.z, other.min.z)};
    max = {std::max(max.x, other.max.x), std::max(max.y, other.max.y), std::max(max.z, other.max.z)};
  }
  bool is_empty() const { return !(min.x <= max.x); }
  double diagonal() const { return is_empty() ? 0 : norm(max - min); }
};

}  // namespace remesh
