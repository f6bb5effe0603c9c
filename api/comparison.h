/// How far two meshes are apart, from bytes to JSON. The daemon and the command line share it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "api/job.h"
#include "api/report_json.h"
#include "core/base/run_control.h"
#include "core/remesh.h"

namespace remesh::api {

/// Collects the one option of a comparison, `tolerance`, from all the places where it may occur.
class ComparisonOptions {
 public:
  /// Errors: kUnknownOption; kInvalidOption - given twice, not a number, or not above 0.
  void add(std::string_view name, std::string_view text);
  std::optional<double> tolerance() const { return tolerance_; }

 private:
  std::optional<double> tolerance_;
};

/// One of the two meshes.
struct ComparedMesh {
  PolygonMesh mesh;
  double read_ms = 0;
};

struct ComparisonAnswer {
  verification::TwoWayDistance distance;
  std::optional<double> tolerance;
  std::uint64_t input_faces = 0;  ///< those of both meshes
  StageTimes times;

  /// Nothing if there was no tolerance.
  std::optional<bool> is_within() const;
};

/// Reads one of the meshes.
/// Errors: those of reading; kInvalidOption - a mesh in JSON has options beside it.
ComparedMesh read_compared(Job job, const Limits& limits, RunControl& control);

/// Errors: those of compare_surfaces.
ComparisonAnswer compare(ComparedMesh a, ComparedMesh b, std::optional<double> tolerance, const Limits& limits,
                         RunControl& control);

/// The answer as a JSON document.
std::string comparison_document(const ComparisonAnswer& answer);

}  // namespace remesh::api
