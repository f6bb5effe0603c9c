#include "api/surface_list.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <numbers>
#include <span>
#include <utility>

#include "api/quoting.h"
#include "core/base/number_text.h"
#include "core/output/report/surface_words.h"

namespace remesh::api {
namespace {

using Surfaces = std::vector<const RecognisedSurface*>;

/// If there are more sizes than this, some are counted together.
constexpr std::size_t kMaxSizes = 8;
constexpr int kMaxDigits = 6;
/// A surface that covers a larger part of a turn goes all around its axis.
constexpr double kFullTurnDeg = 359.5;

/// A number that describes a surface, and how far it may be from the true one.
struct Measure {
  double value = 0;
  double error = 0;
};

/// Rounds a number to a number of significant digits.
double rounded(double value, int digits) {
  std::array<char, 32> text{};
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific, digits - 1);
  std::from_chars(text.data(), end.ptr, value);
  return value;
}

/// Formats a number with only as many digits as its error allows.
std::string measure_text(const Measure& measure) {
  int digits = 1;
  while (digits < kMaxDigits && std::fabs(rounded(measure.value, digits) - measure.value) > measure.error) ++digits;
  return shortest_text(rounded(measure.value, digits));
}

/// Returns the max ratio of a radius's error to the error of the points on its arc.
double arc_leverage(double sweep_deg) {
  if (sweep_deg >= 180) return 1;
  constexpr double kMinHeight = 1e-6;
  return 1 / std::max(1 - std::cos(sweep_deg / 2 * std::numbers::pi / 180), kMinHeight);
}

/// Returns the numbers that describe the size of a surface. All surfaces of a kind have the same number of them.
/// Input: `error` is the distance of the true surface from this one over its facets.
std::vector<Measure> measures_of(const RecognisedSurface& surface, double error) {
  const AnalyticSurface& shape = surface.shape;
  switch (shape.kind) {
    case SurfaceKind::kCylinder: return {{shape.radius, error * arc_leverage(surface.sweep_deg)}};
    case SurfaceKind::kSphere: return {{shape.radius, error}};
    case SurfaceKind::kTorus:
      return {{shape.radius, error * arc_leverage(surface.sweep_deg)}, {shape.minor_radius, error}};
    case SurfaceKind::kCone: {
      // This is a lower bound of the facets' length from the apex outwards: their area over the length of the largest
      // circle around them.
      const double length = surface.area / (std::numbers::pi * surface.extent.diagonal());
      const double angle = length > 0 ? 2 * error / length : 0;
      constexpr double kDegrees = 180 / std::numbers::pi;
      return {{shape.half_angle * kDegrees, angle * kDegrees}};
    }
    case SurfaceKind::kRevolution: {
      double largest = 0;
      for (const Vec2& at : surface.profile) largest = std::max(largest, at.x);
      return {{largest, error * arc_leverage(surface.sweep_deg)}};
    }
    case SurfaceKind::kPlane:
    case SurfaceKind::kFree: break;
  }
  return {};
}

std::string size_text(const RecognisedSurface& surface) {
  const std::vector<Measure> measures = measures_of(surface, surface.deviation);
  switch (surface.shape.kind) {
    case SurfaceKind::kCylinder:
    case SurfaceKind::kSphere: return "of r " + measure_text(measures[0]);
    case SurfaceKind::kTorus: return "of R " + measure_text(measures[0]) + ", r " + measure_text(measures[1]);
    case SurfaceKind::kCone: return "of " + measure_text(measures[0]) + " degrees";
    case SurfaceKind::kRevolution: return "of r up to " + measure_text(measures[0]);
    case SurfaceKind::kPlane:
    case SurfaceKind::kFree: break;
  }
  return "";
}

/// The way in which the facets of a surface look. Only surfaces that look the same way are counted together.
enum class Look : std::uint8_t { kConvex, kConcave, kBoth, kHole, kShaft };

Look look_of(const RecognisedSurface& surface) {
  const bool is_whole = surface.shape.kind == SurfaceKind::kCylinder && surface.sweep_deg >= kFullTurnDeg;
  switch (surface.side) {
    case SurfaceSide::kConvex: return is_whole ? Look::kShaft : Look::kConvex;
    case SurfaceSide::kConcave: return is_whole ? Look::kHole : Look::kConcave;
    case SurfaceSide::kBoth: break;
  }
  return Look::kBoth;
}

std::string look_text(Look look, std::size_t count) {
  const std::string plural = count == 1 ? "" : "s";
  switch (look) {
    case Look::kConvex: return "convex";
    case Look::kConcave: return "concave";
    case Look::kBoth: return "both sides";
    case Look::kHole: return "hole" + plural;
    case Look::kShaft: return "shaft" + plural;
  }
  return "";
}

double area_of(std::span<const RecognisedSurface* const> surfaces) {
  double area = 0;
  for (const RecognisedSurface* surface : surfaces) area += surface->area;
  return area;
}

/// Divides surfaces with the same kind and look into groups of equal size. Each group is divided by each measure in
/// turn.
std::vector<Surfaces> divide_by_size(Surfaces surfaces) {
  const std::size_t measures = measures_of(*surfaces.front(), 0).size();
  std::vector<Surfaces> parts{std::move(surfaces)};
  for (std::size_t m = 0; m < measures; ++m) {
    std::vector<Surfaces> finer;
    for (const Surfaces& part : parts) {
      std::vector<std::pair<Measure, const RecognisedSurface*>> sorted;
      for (const RecognisedSurface* surface : part)
        sorted.emplace_back(measures_of(*surface, surface->tolerance)[m], surface);
      std::stable_sort(sorted.begin(), sorted.end(),
                       [](const auto& a, const auto& b) { return a.first.value < b.first.value; });
      Measure first;
      for (const auto& [measure, surface] : sorted) {
        const bool is_same =
            surface != sorted.front().second && measure.value - first.value <= measure.error + first.error;
        if (!is_same) {
          finer.emplace_back();
          first = measure;
        }
        finer.back().push_back(surface);
      }
    }
    parts = std::move(finer);
  }
  return parts;
}

const RecognisedSurface& largest_of(const Surfaces& surfaces) {
  return **std::max_element(surfaces.begin(), surfaces.end(),
                            [](const RecognisedSurface* a, const RecognisedSurface* b) { return a->area < b->area; });
}

/// Describes the sizes of surfaces of one kind: ` of r 2.5`, or `: 8 of r 2.5, 6 of r 3.175`.
std::string sizes_text(const Surfaces& surfaces) {
  std::map<Look, Surfaces> by_look;
  for (const RecognisedSurface* surface : surfaces) by_look[look_of(*surface)].push_back(surface);
  std::vector<std::pair<Look, Surfaces>> sizes;
  for (auto& [look, part] : by_look)
    for (Surfaces& same : divide_by_size(std::move(part))) sizes.emplace_back(look, std::move(same));
  std::stable_sort(sizes.begin(), sizes.end(),
                   [](const auto& a, const auto& b) { return area_of(a.second) > area_of(b.second); });
  const bool are_all_convex = by_look.size() == 1 && by_look.begin()->first == Look::kConvex;
  const auto describe = [&](const std::pair<Look, Surfaces>& size) {
    const std::string look = are_all_convex ? "" : " (" + look_text(size.first, size.second.size()) + ")";
    return size_text(largest_of(size.second)) + look;
  };
  if (sizes.size() == 1) return " " + describe(sizes.front());
  // One more size is listed rather than a note that there is one other size.
  const std::size_t listed = sizes.size() > kMaxSizes + 1 ? kMaxSizes : sizes.size();
  std::string text;
  for (std::size_t i = 0; i < listed; ++i)
    text += (i == 0 ? ": " : ", ") + grouped_digits(sizes[i].second.size()) + " " + describe(sizes[i]);
  if (listed == sizes.size()) return text;
  std::uint64_t others = 0;
  for (std::size_t i = listed; i < sizes.size(); ++i) others += sizes[i].second.size();
  return text + ", " + grouped_digits(others) + " of " + grouped_digits(sizes.size() - listed) + " other sizes";
}

std::string facets_text(std::uint64_t facets) { return grouped_digits(facets) + (facets == 1 ? " facet" : " facets"); }

std::string with_article(SurfaceKind kind) { return "a" + count_text(1, kind).substr(1); }

/// Says why one free region has no surface.
std::string reason_text(const RecognisedSurface& region) {
  if (region.reason == FreeReason::kFewFacets) return ": too few facets to recognise a surface";
  if (region.nearest_kind == SurfaceKind::kFree) return "";
  const std::string nearest = ": " + with_article(region.nearest_kind);
  if (region.reason == FreeReason::kUnevenFacets)
    return nearest + " fits, but the facets are too uneven to be meant as one";
  return nearest + " comes nearest, " + shortest_text(rounded(region.nearest_deviation, 2)) + " away";
}

/// Says how many facets free regions have, and why no surface was found for them.
std::string free_text(const Surfaces& regions, std::uint64_t facets) {
  const std::string text = " of " + facets_text(facets);
  if (regions.size() == 1) return text + reason_text(*regions.front());
  std::map<SurfaceKind, std::uint64_t> nearest;
  for (const RecognisedSurface* region : regions)
    if (region->nearest_kind != SurfaceKind::kFree) ++nearest[region->nearest_kind];
  std::string list;
  for (const auto& [kind, count] : nearest) {
    list += list.empty() ? ": " + with_article(kind) + " comes nearest to " : ", " + with_article(kind) + " to ";
    list += grouped_digits(count);
  }
  return text + list;
}

}  // namespace

std::vector<SurfaceGroup> list_surfaces(const RecognisedSurfaces& recognised) {
  std::map<SurfaceKind, Surfaces> by_kind;
  for (const RecognisedSurface& surface : recognised.surfaces) by_kind[surface.shape.kind].push_back(&surface);
  std::vector<SurfaceGroup> groups;
  for (const auto& [kind, surfaces] : by_kind) {
    SurfaceGroup group{kind, surfaces.size(), 0, area_of(surfaces), count_text(surfaces.size(), kind)};
    for (const RecognisedSurface* surface : surfaces) group.faces += surface->faces;
    if (kind == SurfaceKind::kFree)
      group.text += free_text(surfaces, group.faces);
    else if (kind != SurfaceKind::kPlane)
      group.text += sizes_text(surfaces);
    groups.push_back(std::move(group));
  }
  std::stable_sort(groups.begin(), groups.end(),
                   [](const SurfaceGroup& a, const SurfaceGroup& b) { return a.area > b.area; });
  return groups;
}

}  // namespace remesh::api
