#include "api/summary.h"

#include <algorithm>

#include "api/quoting.h"
#include "core/base/number_text.h"
#include "core/remesh.h"

namespace remesh::api {
namespace {

/// Replaces control characters by blanks, so that a message fits into one line of a comment.
std::string in_one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
  return text;
}

/// Formats the bound on the distance as a sentence.
std::string distance_text(const DistanceBound& bound) {
  if (bound.output_to_input == bound.input_to_output)
    return "proven: input and result are nowhere more than " + shortest_text(bound.output_to_input) + " apart";
  return "proven: no point of the result is more than " + shortest_text(bound.output_to_input) +
         " from the input, and no point of the input more than " + shortest_text(bound.input_to_output) +
         " from the result";
}

}  // namespace

std::string warning_text(const Diagnostic& diagnostic) {
  return in_one_line(std::string(diagnostic_name(diagnostic.code)) + ": " + std::to_string(diagnostic.count) + ": " +
                     diagnostic.message);
}

Summary summary_of(const Report& report) {
  Summary summary;
  summary.input_faces = report.input.faces;
  summary.output_faces = report.output.faces;
  summary.patches = report.patches.size();
  summary.kept = static_cast<std::uint64_t>(
      std::count_if(report.patches.begin(), report.patches.end(),
                    [](const PatchSummary& patch) { return patch.status == PatchStatus::kKept; }));
  summary.min_angle_deg = report.output.quality.min_angle_deg;
  summary.is_verified = report.verified.all_true();
  for (const Diagnostic& diagnostic : report.diagnostics) summary.warnings.push_back(warning_text(diagnostic));
  for (const Unrefined& left : report.unrefined) summary.unrefined.emplace_back(left.reason, left.count);
  summary.distance_bound = report.distance_bound;
  summary.origin = report.output_origin;
  return summary;
}

std::string origin_text(const Vec3& origin) {
  return shortest_text(origin.x) + " " + shortest_text(origin.y) + " " + shortest_text(origin.z);
}

std::string summary_line(const Summary& summary) {
  return "input_faces=" + std::to_string(summary.input_faces) +
         ", output_faces=" + std::to_string(summary.output_faces) + ", patches=" + std::to_string(summary.patches) +
         ", kept=" + std::to_string(summary.kept) + ", min_angle_deg=" + shortest_text(summary.min_angle_deg) +
         ", verified=" + (summary.is_verified ? "1" : "0") + ", warnings=" + std::to_string(summary.warnings.size()) +
         (summary.origin ? ", origin=" + origin_text(*summary.origin) : "");
}

std::vector<std::string> summary_comments(const Summary& summary) {
  const std::string origin = summary.origin ? ", origin " + origin_text(*summary.origin) : "";
  std::vector<std::string> comments{"remeshd " + std::string(version()) + origin, summary_line(summary)};
  if (summary.distance_bound) comments.push_back(distance_text(*summary.distance_bound));
  for (const std::string& warning : summary.warnings) comments.push_back("warning: " + warning);
  for (const auto& [reason, count] : summary.unrefined)
    comments.push_back("unrefined: " + std::string(unrefined_name(reason)) + ": " + std::to_string(count));
  return comments;
}

}  // namespace remesh::api
