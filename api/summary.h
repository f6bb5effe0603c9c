/// An answer describes itself in one line, and in the comments of mesh formats.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/output/report.h"

namespace remesh::api {

struct Summary {
  std::uint64_t input_faces = 0;
  std::uint64_t output_faces = 0;
  std::uint64_t patches = 0;
  std::uint64_t kept = 0;  ///< patches
  double min_angle_deg = 0;
  bool is_verified = false;
  std::vector<std::string> warnings;  ///< a line each
  std::vector<std::pair<UnrefinedReason, std::uint64_t>> unrefined;
  std::optional<Vec3> origin;  ///< that the written coordinates are relative to

  friend bool operator==(const Summary&, const Summary&) = default;
};

Summary summary_of(const Report& report);

/// Three numbers with blanks between them, in their shortest digits.
std::string origin_text(const Vec3& origin);

/// `input_faces=..., output_faces=..., patches=..., kept=..., min_angle_deg=..., verified=1, warnings=...`, and
/// `, origin=x y z` where there is an origin.
std::string summary_line(const Summary& summary);

/// That, and in lines of their own the warnings and what refinement left: what a mesh format has no other place for. No
/// times and no id: the same in every run. The first line, which binary STL has room for, names the version, and the
/// origin if there is one.
std::vector<std::string> summary_comments(const Summary& summary);

}  // namespace remesh::api
