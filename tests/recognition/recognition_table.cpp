/// Judges recognition: prints what is claimed of each mesh, and what the truth is if it is known.
/// Usage: recognition_table [--faces] [--runs N] MESH...
/// A mesh with a table of surfaces beside it (NAME.surfaces.tsv for NAME.stl) is judged by kind, as areas in percent.
/// For every mesh the claimed surfaces are held against its vertices by formulas that the core does not have.
///   --faces  one line more for each STEP face that is not right, and for each claimed surface of other meshes
///   --runs   the stage is timed so often (3), and the shortest time counts
/// Exit code: 0 - all bounds hold; 1 - the bounds that do not hold are listed; 2 - usage, or a mesh cannot be read.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/tolerance.h"
#include "core/io/gzip.h"
#include "core/io/mesh_files.h"
#include "tests/recognition/judged_file.h"

namespace remesh::recognition {
namespace {

constexpr double kMinRightPercent = 97;
constexpr double kMaxFreeFormPercent = 0.5;
constexpr double kMinEvidentPercent = 95;
constexpr double kMaxMicrosPerFace = 1.5;
/// A smaller mesh is not timed against the bound, because fixed costs and the clock weigh too much.
constexpr std::size_t kMinTimedFaces = 5'000;
/// A tolerance of so many rounding steps is still the rounding of the file.
constexpr double kMaxToleranceSteps = 10;

struct Settings {
  bool want_faces = false;
  int runs = 3;
};

using Faults = std::vector<std::string>;

/// The areas of all judged files together, by kind. Each file counts as much as any other, whatever its units.
using KindSums = std::map<SurfaceKind, KindAreas>;

PolygonMesh read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error("cannot be opened");
  std::string content{std::istreambuf_iterator<char>(file), {}};
  RunControl control;
  if (is_gzip(content)) content = gunzip(content, DecompressionLimits{}, control);
  return read_mesh(sniff_format(content), content, ReadLimits{}, control).mesh;
}

double percent(double part, double whole) { return whole > 0 ? 100 * part / whole : 0; }

std::string name_of(SurfaceKind kind) { return kind == SurfaceKind::kFree ? "other" : std::string(kind_name(kind)); }

std::string text(const char* format, auto... values) {
  char buffer[256];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

std::string description(const test::PlainSurface& s) {
  std::string result(kind_name(s.kind));
  switch (s.kind) {
    case SurfaceKind::kCylinder:
    case SurfaceKind::kSphere: return result + text(" r %.9g", s.radius);
    case SurfaceKind::kCone: return result + text(" of %.9g deg", s.half_deg);
    case SurfaceKind::kTorus: return result + text(" R %.9g r %.9g", s.radius, s.tube);
    case SurfaceKind::kRevolution: return result + text(" of %zu points", s.profile.size());
    default: return result;
  }
}

void print_face(const FaceVerdict& verdict, const JudgedFile& file) {
  const StepFace& face = *verdict.face;
  std::printf(
      "    face %d: %s, %u triangles, %zu facets, off %.2f steps, turn %.0f deg%s\n", face.number,
      face.surface.kind == SurfaceKind::kFree ? ("other " + face.detail).c_str() : description(face.surface).c_str(),
      face.count, verdict.shape.facets, verdict.shape.off / file.step, verdict.shape.turn_deg,
      verdict.is_judged ? "" : ", not judged");
  for (const auto& [s, part] : verdict.parts) {
    const double share = percent(part.area, verdict.shape.area);
    if (!s.is_valid()) {
      std::printf("      %5.1f %% not claimed\n", share);
      continue;
    }
    std::printf("      %5.1f %% %s as s%u %s", share, part.error.is_right(file.step) ? "right" : "WRONG", s.value,
                description(test::plain(file.claims.surfaces()[s])).c_str());
    if (face.surface.kind != SurfaceKind::kFree)
      std::printf(", distance %.2f steps, radius %.2f of %.2f steps", part.error.distance / file.step,
                  part.error.radius / file.step, part.error.radius_bound / file.step);
    std::printf("\n");
  }
}

void print_judged(const JudgedFile& file, const std::string& name, const Settings& settings, Faults& faults) {
  std::printf("  %-9s %6s %7s %8s %8s %8s %8s %8s %8s\n", "kind", "faces", "judged", "area", "judged", "right", "kind?",
              "shape?", "missed");
  double total = 0;
  for (const auto& [kind, sum] : file.kinds) total += sum.all;
  for (const auto& [kind, sum] : file.kinds) {
    if (kind == SurfaceKind::kFree) {
      std::printf("  %-9s %6zu         %7.3f%%   claimed %.3f %%, of which %.3f %% lie on what is claimed\n", "other",
                  sum.faces, percent(sum.all, total), percent(sum.claimed, sum.all), percent(sum.fitting, sum.all));
      if (percent(sum.claimed - sum.fitting, sum.all) > kMaxFreeFormPercent)
        faults.push_back(
            name + text(": %.3f %% of the free-form area is claimed", percent(sum.claimed - sum.fitting, sum.all)));
      continue;
    }
    const double right = percent(sum.right, sum.judged);
    const bool is_bound = kind != SurfaceKind::kPlane && sum.judged > 0;
    const bool holds = !is_bound || right >= kMinRightPercent;
    std::printf("  %-9s %6zu %7zu %7.3f%% %7.2f%% %7.2f%% %7.3f%% %7.3f%% %7.3f%%%s\n", name_of(kind).c_str(),
                sum.faces, sum.judged_faces, percent(sum.all, total), percent(sum.judged, sum.all), right,
                percent(sum.wrong_kind, sum.judged), percent(sum.wrong_shape, sum.judged),
                percent(sum.unclaimed, sum.judged), holds ? "" : "  *");
    if (!holds)
      faults.push_back(name + text(": %.2f %% of the area of the kind %s is right", right, name_of(kind).c_str()));
  }
  if (!settings.want_faces) return;
  for (const FaceVerdict& verdict : file.verdicts) {
    const bool is_free = verdict.face->surface.kind == SurfaceKind::kFree;
    const bool is_unclaimed = verdict.parts.size() == 1 && !verdict.parts.begin()->first.is_valid();
    if (is_free ? !is_unclaimed : verdict.right < 0.999 * verdict.shape.area) print_face(verdict, file);
  }
}

void print_claims(const PolygonMesh& mesh, const JudgedFile& file, const std::string& name, const Settings& settings,
                  Faults& faults) {
  struct Sum {
    std::size_t surfaces = 0;
    std::size_t faces = 0;
    double area = 0;
    double deviation = 0;  ///< the largest, in units of the surface's tolerance
    double steps = 0;      ///< the largest, in rounding steps
    double tilt_deg = 0;
  };
  // Doubles are judged by the finest tolerance that the pipeline has for planes, because models are computed in many
  // steps.
  const double step = std::max({file.claims.report.rounding_step, test::written_step(mesh),
                                kToleranceFloor * file.claims.report.input.bounding_box.diagonal()});
  std::map<SurfaceKind, Sum> sums;
  double total = 0;
  for (const RecognisedSurface& s : file.claims.surfaces()) ++sums[s.shape.kind].surfaces;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    Sum& sum = sums[file.claims.kind_of(FaceId(f))];
    const double area = test::area_of(mesh, FaceId(f));
    ++sum.faces;
    sum.area += area;
    total += area;
  }
  for (const test::ClaimFit& fit : file.fits) {
    const RecognisedSurface& s = file.claims.surfaces()[fit.surface];
    Sum& sum = sums[s.shape.kind];
    sum.deviation = std::max(sum.deviation, fit.deviation / s.tolerance);
    sum.steps = std::max(sum.steps, fit.deviation / step);
    sum.tilt_deg = std::max(sum.tilt_deg, fit.tilt_deg);
    const std::string which = name + text(": s%u ", fit.surface.value) + description(test::plain(s));
    if (!(fit.deviation <= s.tolerance))
      faults.push_back(which + text(" has a corner %.3g from it, its tolerance is %.3g", fit.deviation, s.tolerance));
    if (!(s.tolerance <= kMaxToleranceSteps * step))
      faults.push_back(which + text(" has the tolerance %.3g, a rounding step is %.3g", s.tolerance, step));
  }
  std::printf("  claimed");
  for (const auto& [kind, sum] : sums) {
    std::printf("%s %zu %s (%.2f %% area, %.1f %% faces", kind == sums.begin()->first ? "" : ";", sum.surfaces,
                std::string(kind_name(kind)).c_str(), percent(sum.area, total),
                percent(static_cast<double>(sum.faces), static_cast<double>(mesh.face_count())));
    if (kind != SurfaceKind::kPlane && kind != SurfaceKind::kFree)
      std::printf(", off %.2f steps = %.2f of tolerance, tilt %.1f", sum.steps, sum.deviation, sum.tilt_deg);
    std::printf(")");
  }
  std::printf("\n");
  if (!settings.want_faces) return;
  for (const test::ClaimFit& fit : file.fits) {
    const RecognisedSurface& s = file.claims.surfaces()[fit.surface];
    std::printf(
        "    s%u %s: %llu faces, %llu patches, area %.4g, sweep %.1f, off %.2f steps of %.2f, told %.2f, tilt %.1f\n",
        fit.surface.value, description(test::plain(s)).c_str(), static_cast<unsigned long long>(s.faces),
        static_cast<unsigned long long>(s.patches), s.area, s.sweep_deg, fit.deviation / step, s.tolerance / step,
        s.deviation / step, fit.tilt_deg);
  }
}

/// Returns the finest tessellation of the same STEP file, NAME-5.stl beside NAME-20.stl.
std::optional<FinerTessellation> finer_beside(const std::string& path) {
  const std::size_t dash = path.rfind('-');
  if (dash == std::string::npos) return std::nullopt;
  const std::string finest = path.substr(0, dash) + "-5.stl";
  if (finest == path || !std::filesystem::exists(finest)) return std::nullopt;
  auto faces = truth_beside(finest);
  if (!faces) return std::nullopt;
  return FinerTessellation{read_file(finest), std::move(*faces)};
}

/// Prints what is claimed of STEP faces with enough evidence, and of free-form ones, by what the records tell.
void print_evident(const KindSums& kinds, const std::string& name, Faults& faults) {
  double total = 0, evident = 0, right = 0;
  for (const auto& [kind, sum] : kinds) total += sum.all;
  std::printf("  by what is told:");
  for (const auto& [kind, sum] : kinds) {
    if (kind == SurfaceKind::kPlane) continue;
    if (kind == SurfaceKind::kFree) {
      const double far = percent(sum.too_far, sum.all);
      std::printf(" other %.2f %% of area, %.3f %% too far;", percent(sum.all, total), far);
      if (far > kMaxFreeFormPercent)
        faults.push_back(name + text(": %.3f %% of the free-form area is farther than told", far));
      continue;
    }
    evident += sum.evident;
    right += sum.evident_right;
    std::printf(" %s %.2f %% evident, %.2f %% right;", name_of(kind).c_str(), percent(sum.evident, sum.all),
                percent(sum.evident_right, sum.evident));
  }
  std::printf(" all %.2f %% right\n", percent(right, evident));
  if (percent(right, evident) < kMinEvidentPercent && evident > 0)
    faults.push_back(name + text(": %.2f %% of the area with enough evidence is right", percent(right, evident)));
}

void judge_file(const std::string& path, const Settings& settings, KindSums& sums, Faults& faults) {
  const PolygonMesh mesh = read_file(path);
  const auto truth = truth_beside(path);
  const auto finer = truth ? finer_beside(path) : std::nullopt;
  const JudgedFile file = judge(mesh, truth ? &*truth : nullptr, settings.runs, finer ? &*finer : nullptr);
  double whole = 0;
  for (const auto& [kind, areas] : file.kinds) whole += areas.all;
  for (const auto& [kind, areas] : file.kinds) sums[kind].add(areas, whole);
  const std::string name = std::filesystem::path(path).filename().string();
  std::printf("%s: %zu faces, %zu facets, step %.3g (the report's is %.3g), %.3f us a face\n", name.c_str(),
              mesh.face_count(), file.claims.report.patches.size(), file.step, file.claims.report.rounding_step,
              file.micros_per_face);
  if (truth) {
    print_judged(file, name, settings, faults);
    print_evident(file.kinds, name, faults);
  }
  print_claims(mesh, file, name, truth ? Settings{} : settings, faults);
  if (mesh.face_count() >= kMinTimedFaces && file.micros_per_face > kMaxMicrosPerFace)
    faults.push_back(name + text(": the stage takes %.2f us a face", file.micros_per_face));
  std::fflush(stdout);
}

int run(const std::vector<std::string>& arguments) {
  Settings settings;
  std::vector<std::string> paths;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (arguments[i] == "--faces") {
      settings.want_faces = true;
    } else if (arguments[i] == "--runs" && i + 1 < arguments.size()) {
      settings.runs = std::atoi(arguments[++i].c_str());
    } else if (arguments[i].starts_with("--")) {
      paths.clear();
      break;
    } else {
      paths.push_back(arguments[i]);
    }
  }
  if (paths.empty()) {
    std::fprintf(stderr, "usage: recognition_table [--faces] [--runs N] MESH...\n");
    return 2;
  }
  Faults faults;
  KindSums sums;
  int code = 0;
  for (const std::string& path : paths) {
    try {
      judge_file(path, settings, sums, faults);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s: %s\n", path.c_str(), error.what());
      code = 2;
    }
  }
  if (!sums.empty()) {
    std::printf("\nall files, each with the same weight\n");
    print_evident(sums, "all files", faults);
  }
  std::printf("\n%zu bounds do not hold\n", faults.size());
  for (const std::string& fault : faults) std::printf("  %s\n", fault.c_str());
  return code != 0 ? code : faults.empty() ? 0 : 1;
}

}  // namespace
}  // namespace remesh::recognition

int main(int argc, char** argv) { return remesh::recognition::run({argv + 1, argv + argc}); }
