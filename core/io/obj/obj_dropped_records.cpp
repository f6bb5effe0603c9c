#include "core/io/obj/obj_dropped_records.h"

#include "core/io/common/read_errors.h"

namespace remesh {
namespace {

constexpr std::size_t kMaxKeywordLength = 32;

std::string meaning(std::string_view keyword) {
  if (keyword == "vt") return " (texture coordinates)";
  if (keyword == "vn") return " (normals)";
  if (keyword == "vp") return " (parameter space)";
  if (keyword == "vw") return " (skin weights)";
  if (keyword == "s") return " (smoothing groups)";
  if (keyword == "l") return " (lines)";
  if (keyword == "p") return " (points)";
  return "";
}

void report_vertices(Diagnostic found, const char* message, std::vector<Diagnostic>& diagnostics) {
  if (found.count == 0) return;
  found.code = DiagnosticCode::kAttributeDropped;
  found.message = message + std::to_string(found.count);
  diagnostics.push_back(std::move(found));
}

}  // namespace

void DroppedRecords::count(std::string_view keyword, std::uint64_t records) {
  if (keyword.size() > kMaxKeywordLength) keyword = kOther;
  if (last_ == kinds_.size() || kinds_[last_].first != keyword) last_ = find(keyword);
  kinds_[last_].second += records;
}

void DroppedRecords::report(std::vector<Diagnostic>& diagnostics) const {
  for (const auto& [keyword, count] : kinds_)
    record_dropped(keyword + " records" + meaning(keyword) + " dropped", count, diagnostics);
}

std::size_t DroppedRecords::find(std::string_view keyword) {
  for (std::size_t i = 0; i < kinds_.size(); ++i) {
    if (kinds_[i].first == keyword) return i;
  }
  if (kinds_.size() == kMaxKinds) return kMaxKinds - 1;
  kinds_.emplace_back(kinds_.size() + 1 == kMaxKinds ? kOther : keyword, 0);
  return kinds_.size() - 1;
}

std::vector<Diagnostic> ObjExtras::diagnostics() && {
  std::vector<Diagnostic> diagnostics;
  dropped.report(diagnostics);
  report_vertices(
      std::move(extra_values),
      "values after x y z (weights, colours) were dropped; number of vertices that had them: ", diagnostics);
  report_vertices(std::move(missing_z), "missing z read as 0; number of vertices without z: ", diagnostics);
  return diagnostics;
}

}  // namespace remesh
