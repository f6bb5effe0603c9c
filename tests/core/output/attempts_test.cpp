// An attempt is a function of the decisions: made for the last decisions of a run alone, it gives the run's result.

#include "core/output/run/attempts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/output/run/learn.h"
#include "core/output/run/run_report.h"
#include "core/output/run/trace.h"
#include "core/remesh.h"
#include "tests/support/hostile_families.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

struct Case {
  std::string name;
  PolygonMesh mesh;
  Options options;
};

/// Makes a plate with a step on it that is lower than the details which are removed.
PolygonMesh with_low_step() { return shapes::prism({{0, 0}, {4, 0}, {4, 1}, {2, 1}, {2, 1.001}, {0, 1.001}}, 1); }

/// Makes strips of three triangles with corners at random, which cross each other.
PolygonMesh strips_through_each_other(std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3> positions;
  std::vector<std::vector<std::uint32_t>> faces;
  for (std::uint32_t strip = 0; strip < 8; ++strip) {
    for (int i = 0; i < 5; ++i)
      positions.push_back({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
    const std::uint32_t first = 5 * strip;
    for (std::uint32_t i = first; i < first + 3; ++i)
      faces.push_back({i, i + 1 + (i - first) % 2, i + 2 - (i - first) % 2});
  }
  return shapes::from_lists(positions, faces);
}

std::vector<Case> cases() {
  std::vector<Case> cases;
  Options fine, small_details, curved, cut_and_coarser;
  fine.proximity = 1;
  small_details.defeature_size = 1e-2;
  curved.elements_per_circle = 12;
  curved.circle_fit = CircleFit::kVolume;
  cut_and_coarser.repair.make_union = true;
  cut_and_coarser.plane_tolerance = 0.3;
  cut_and_coarser.surface_tolerance = 0.05;
  // With these two, patches fail at first, and cuts then fail their check.
  for (const std::uint64_t seed : {19, 41})
    cases.push_back({"strips", strips_through_each_other(seed), cut_and_coarser});
  cases.push_back({"box", shapes::box({1, 1, 1}, 2), {}});
  cases.push_back({"thin", shapes::box({1, 1, 0.01}), fine});
  cases.push_back({"details", with_low_step(), small_details});
  cases.push_back({"cylinder", shapes::cylinder(48, 1, 2), curved});
  for (const hostile::Family& family : hostile::families())
    cases.push_back({std::string(family.name), family.make(120), {}});
  return cases;
}

/// Makes attempts until one is the answer, and returns the decisions for it.
std::pair<Decisions, Effort> decide(const Case& of, std::vector<std::string>& trace) {
  RunControl control;
  Attempts attempts(of.mesh, of.options, Storage::kDouble, {}, control);
  Decisions decisions = attempts.first_decisions();
  Effort effort;
  for (;;) {
    const Outcome outcome = attempts.attempt(decisions, effort);
    const Effort after = spent(effort, decisions, outcome);
    const std::optional<Decisions> next = learn(decisions, outcome, after);
    trace.push_back(line_of_trace(static_cast<int>(trace.size()) + 1, decisions, outcome, next));
    if (!next) return {decisions, effort};
    effort = next->mending == decisions.mending ? after : for_another_surface(after);
    decisions = *next;
  }
}

TEST(attempts, an_attempt_depends_on_its_decisions_alone) {
  std::size_t most_attempts = 0;
  std::ptrdiff_t cut_in_vain = 0;
  for (const Case& of : cases()) {
    std::vector<std::string> trace;
    const auto [decisions, effort] = decide(of, trace);
    most_attempts = std::max(most_attempts, trace.size());
    const auto is_cut_in_vain = [](const std::string& line) { return line.find("no faces were cut") != line.npos; };
    cut_in_vain += std::count_if(trace.begin(), trace.end(), is_cut_in_vain);
    RunControl control;
    Attempts alone(of.mesh, of.options, Storage::kDouble, {}, control);
    alone.first_decisions();
    ASSERT_EQ(alone.attempt(decisions, effort).end, Outcome::End::kVerified) << of.name;
    const Result result = make_result(alone.take_products(), {});
    const Result of_run = remesh_surface(of.mesh, of.options, {}, control);
    EXPECT_EQ(result.mesh.positions, of_run.mesh.positions) << of.name;
    EXPECT_EQ(result.mesh.faces, of_run.mesh.faces) << of.name;
  }
  EXPECT_GT(most_attempts, 3u) << "some of these take several attempts";
  EXPECT_EQ(cut_in_vain, 2) << "the strips are cut in vain";
}

TEST(attempts, a_run_tells_each_attempt_in_a_line) {
  Options options;
  options.defeature_size = 1e-2;
  const PolygonMesh mesh = with_low_step();
  std::vector<std::string> lines;
  RunSettings settings;
  settings.trace = [&](const std::string& line) { lines.push_back(line); };
  RunControl control;
  const Result result = remesh_surface(mesh, options, settings, control);
  ASSERT_GE(lines.size(), 2u);
  EXPECT_EQ(lines.front(), "attempt 1: details were removed -> next: divide the surface without them");
  EXPECT_EQ(lines.back(), "attempt " + std::to_string(lines.size()) + ": verified, " +
                              std::to_string(result.mesh.faces.size()) + " faces");
}

TEST(attempts, an_analysis_predicts_with_the_goals_of_the_first_attempt) {
  Options options;
  options.max_area = 1e-3;
  const Options without = options;
  options.min_edge_length = 0.25;
  RunControl control;
  const Report told = analyze_surface(shapes::box({1, 1, 1}), options, {}, control);
  EXPECT_EQ(told.min_edge_length, 0.25);
  EXPECT_LT(told.predicted_faces, analyze_surface(shapes::box({1, 1, 1}), without, {}, control).predicted_faces);
}

}  // namespace
}  // namespace remesh
