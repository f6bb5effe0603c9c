/// The description of an answer in one line, and in the comments of mesh formats.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/output/report/report.h"

namespace remesh::api {

struct Summary {
  std::uint64_t input_faces = 0;
  std::uint64_t output_faces = 0;
  std::uint64_t patches = 0;
  std::uint64_t kept = 0;  ///< number of patches with the status `kept`
  double min_angle_deg = 0;
  bool is_verified = false;
  std::vector<std::string> warnings;  ///< one line each
  std::vector<std::pair<UnrefinedReason, std::uint64_t>> unrefined;
  std::optional<DistanceBound> distance_bound;
  std::optional<Vec3> origin;  ///< the point that the written coordinates are relative to

  friend bool operator==(const Summary&, const Summary&) = default;
};

Summary summary_of(const Report& report);

/// Formats a diagnostic as a line of the summary's warnings.
std::string warning_text(const Diagnostic& diagnostic);

/// Formats three numbers with their shortest digits and blanks between them.
std::string origin_text(const Vec3& origin);

/// Formats the summary as one line: `input_faces=..., output_faces=..., patches=..., kept=..., min_angle_deg=...,
/// verified=1, warnings=...`, and `, origin=x y z` if there is an origin.
std::string summary_line(const Summary& summary);

/// Formats the summary as comments, for mesh formats that have no other place for it. The first line names the
/// version, and the origin if there is one; binary STL has room for this line only. Then come the summary line, the
/// proven bound on the distance between input and result, the warnings, and the reasons for unrefined places, one line
/// each. There are no times and no id, so every run gives the same lines.
std::vector<std::string> summary_comments(const Summary& summary);

}  // namespace remesh::api
