#include "api/cli/analysis_text.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <map>
#include <vector>

#include "api/surface_list.h"
#include "core/base/number_text.h"
#include "core/output/report/surface_words.h"

namespace remesh::cli {
namespace {

std::string percent_text(double part, double whole) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f %%", whole > 0 ? 100 * part / whole : 0.0);
  return text.data();
}

std::string size_text(const Box3& box) {
  if (box.is_empty()) return "";
  const Vec3 size = box.max - box.min;
  return ", " + number_text(size.x) + " x " + number_text(size.y) + " x " + number_text(size.z);
}

/// Appends blanks in front of the text, so that it ends at the column.
void append_right(std::string& line, const std::string& text, std::size_t width) {
  line.append(width > text.size() ? width - text.size() : 0, ' ');
  line += text;
}

std::string surface_table(const Report& report) {
  constexpr std::size_t kMinWidth = 9;
  const std::vector<api::SurfaceGroup> groups = api::list_surfaces(report.surfaces);
  double area = 0;
  std::size_t width = kMinWidth;
  for (const api::SurfaceGroup& group : groups) {
    area += group.area;
    width = std::max(width, grouped_digits(group.faces).size() + 3);
  }
  std::string table;
  append_right(table, "area", kMinWidth);
  append_right(table, "faces", width);
  table += "  surfaces\n";
  for (const api::SurfaceGroup& group : groups) {
    append_right(table, percent_text(group.area, area), kMinWidth);
    append_right(table, grouped_digits(group.faces), width);
    table += "  " + group.text + "\n";
  }
  return table;
}

/// Formats the predicted numbers of faces by elements per circle as one line; empty if there are none.
std::string predictions_text(const std::map<int, std::uint64_t>& predictions) {
  if (predictions.empty()) return "";
  std::string elements, faces;
  for (const auto& [number, count] : predictions) {
    const char* const separator = elements.empty() ? "" : " / ";
    elements += separator + grouped_digits(static_cast<std::uint64_t>(number));
    faces += separator + grouped_digits(count);
  }
  return "with --elements-per-circle " + elements + ": about " + faces + " faces\n";
}

}  // namespace

std::string analysis_text(const Report& report, const std::string& name) {
  const MeshStatistics& input = report.input;
  std::string text = name + ": " + grouped_digits(input.faces) + (input.faces == 1 ? " face, " : " faces, ") +
                     (input.closed ? "closed" : "open") + size_text(input.bounding_box) + "\n" + surface_table(report);
  for (const Diagnostic& diagnostic : report.diagnostics) {
    text += "warning: " + std::string(diagnostic_name(diagnostic.code)) + ": " + grouped_digits(diagnostic.count) +
            ": " + diagnostic.message + "\n";
  }
  if (report.smallest_gap) text += "smallest gap between facets: " + number_text(*report.smallest_gap) + "\n";
  text += "a remeshing with these options makes about " + grouped_digits(report.predicted_faces) + " faces\n";
  return text + predictions_text(report.predicted_faces_by_elements_per_circle);
}

}  // namespace remesh::cli
