#include "api/cli/outcome_text.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "api/cli/flag_names.h"
#include "api/quoting.h"
#include "core/base/number_text.h"
#include "core/output/report/surface_words.h"

namespace remesh::cli {
namespace {

/// A part of a sentence that counts things: `3 faces`.
std::string counted(std::uint64_t count, const std::string& one, const std::string& many) {
  return grouped_digits(count) + " " + (count == 1 ? one : many);
}

std::string first_line(std::uint64_t input, std::uint64_t output, double min_angle_deg) {
  return counted(input, "face", "faces") + " in, " + grouped_digits(output) + " out; the least angle is " +
         number_text(min_angle_deg, 3) + " degrees";
}

/// Lists names with their counts: `10 input_angle, 2 size_floor`.
template <class Items, class Name>
std::string list_counts(const Items& items, Name name) {
  std::string text;
  for (const auto& item : items)
    text.append(text.empty() ? "" : ", ").append(grouped_digits(item.count) + " ").append(name(item));
  return text;
}

/// Describes what was given up or missed; empty if nothing was.
std::string missed(const Report& report) {
  std::vector<std::string> parts;
  const auto count_patches = [&](PatchStatus status) {
    return static_cast<std::uint64_t>(std::count_if(report.patches.begin(), report.patches.end(),
                                                    [&](const PatchSummary& p) { return p.status == status; }));
  };
  if (const std::uint64_t kept = count_patches(PatchStatus::kKept); kept > 0)
    parts.push_back("kept as they came: " + counted(kept, "patch", "patches"));
  if (const std::uint64_t reduced = count_patches(PatchStatus::kReduced); reduced > 0)
    parts.push_back("divided more finely than planned: " + counted(reduced, "patch", "patches"));
  if (!report.unrefined.empty())
    parts.push_back("triangles that miss a bound: " +
                    list_counts(report.unrefined, [](const Unrefined& u) { return unrefined_name(u.reason); }));
  if (!report.volume_obstacles.empty())
    parts.push_back(
        "a volume mesher will refuse this: " +
        list_counts(report.volume_obstacles, [](const VolumeObstacle& o) { return diagnostic_name(o.code); }));
  std::string text;
  for (const std::string& part : parts) text.append(text.empty() ? "" : "; ").append(part);
  return text;
}

/// Ranks the diagnostics whose remedies are named: the first one is the most important. The others are not named.
constexpr std::array kCodesWithAdvice{DiagnosticCode::kOpenBoundary, DiagnosticCode::kInsideOut,
                                      DiagnosticCode::kManyFaces, DiagnosticCode::kCurvedSurface};

/// Converts `a_b=1&c=2` to `--a-b 1 --c 2`.
std::string as_flags(std::string_view query) {
  std::string flags;
  while (!query.empty()) {
    const auto [pair, rest] = api::cut(query, '&');
    const auto [name, value] = api::cut(pair, '=');
    flags.append(flags.empty() ? "--" : " --").append(with_hyphens(name)).append(" ").append(value);
    query = rest;
  }
  return flags;
}

bool are_all_given(std::string_view query, const api::Fields& given) {
  while (!query.empty()) {
    const auto [pair, rest] = api::cut(query, '&');
    const std::string_view name = api::cut(pair, '=').first;
    if (std::none_of(given.begin(), given.end(), [&](const auto& option) { return option.first == name; }))
      return false;
    query = rest;
  }
  return true;
}

/// Finds the remedy that would help most; empty if there is none.
std::string advice(const Report& report, const api::Fields& given) {
  for (const DiagnosticCode code : kCodesWithAdvice)
    for (const Diagnostic& diagnostic : report.diagnostics) {
      if (diagnostic.code != code) continue;
      for (const Remedy& remedy : diagnostic.remedies)
        if (!are_all_given(remedy.options, given)) return as_flags(remedy.options) + " " + remedy.effect;
    }
  return "";
}

/// Finds a number in a text of the form `a=1, b=2`.
/// Output: 0 if it is not there.
double number_in(std::string_view summary, std::string_view name) {
  while (!summary.empty()) {
    const auto [pair, rest] = api::cut(summary, ',');
    const auto [found, value] = api::cut(pair, '=');
    if (trim(found) == name) return parse_real(value).value;
    summary = rest;
  }
  return 0;
}

}  // namespace

std::vector<std::string> outcome_lines(const Report& report, const api::Fields& given) {
  const DistanceBound bound = report.distance_bound.value_or(DistanceBound{});
  std::vector<std::string> lines{
      first_line(report.input.faces, report.output.faces, report.output.quality.min_angle_deg) +
      "; input and result are at most " + number_text(std::max(bound.output_to_input, bound.input_to_output), 3) +
      " apart (proven)"};
  for (std::string line : {missed(report), advice(report, given)})
    if (!line.empty()) lines.push_back(std::move(line));
  return lines;
}

std::string outcome_of_summary(std::string_view summary) {
  const auto whole = [&](std::string_view name) { return static_cast<std::uint64_t>(number_in(summary, name)); };
  return first_line(whole("input_faces"), whole("output_faces"), number_in(summary, "min_angle_deg")) + "; " +
         counted(whole("warnings"), "warning", "warnings");
}

}  // namespace remesh::cli
