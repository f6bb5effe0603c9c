/// Writes the report and the mesh of an answer as JSON.
#pragma once

#include <array>
#include <span>
#include <string>

#include "api/json_writer.h"
#include "api/options.h"
#include "core/base/run_control.h"
#include "core/remesh.h"

namespace remesh::api {

/// The time that each stage took, including reading and writing.
class StageTimes {
 public:
  void add(Stage stage, double ms) {
    double& sum = ms_[static_cast<std::size_t>(stage)];
    sum = (ran(stage) ? sum : 0) + ms;
  }
  bool ran(Stage stage) const { return ms_[static_cast<std::size_t>(stage)] >= 0; }
  double of(Stage stage) const { return ms_[static_cast<std::size_t>(stage)]; }
  double total() const;

 private:
  static constexpr double kDidNotRun = -1;
  static constexpr std::array<double, kStageCount> none() {
    std::array<double, kStageCount> all{};
    all.fill(kDidNotRun);
    return all;
  }
  std::array<double, kStageCount> ms_ = none();
};

enum class ReportKind {
  kRemesh,
  kAnalysis,  ///< without `output`, `unrefined` and `verified`
};

/// Writes an option's value, or null if none is set.
void write_option_value(JsonWriter& json, const OptionValue& value);

/// Writes the programs that read a written format, what they take of it, and the lines with which they go on.
/// Input: `filling` - the lines with which Gmsh fills the file that was written; none if there is none.
void write_programs(JsonWriter& json, std::string_view name, Format format, std::span<const std::string> filling);

/// Writes the report object. The report's own options replace `options.core`.
void write_report(JsonWriter& json, const Report& report, const RequestOptions& options, ReportKind kind,
                  const StageTimes& times, RunControl& control);

/// Writes the mesh object: vertices, faces, face_patch, face_source, input_face_patch, and the labels that the input
/// had.
void write_mesh(JsonWriter& json, const Result& result, RunControl& control);

}  // namespace remesh::api
