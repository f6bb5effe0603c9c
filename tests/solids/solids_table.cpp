// Runs the table of solids as they are, turned, scaled, moved, shuffled and divided, and holds the arrangement and the
// union of each against what is known of them. `./dev solids` runs it.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/geometry/exact/predicates_3d.h"
#include "core/geometry/intersections/self_intersections.h"
#include "core/io/mesh_files.h"
#include "core/solids/solid_union.h"
#include "tests/solids/solid_measures.h"
#include "tests/solids/solid_rows.h"
#include "tests/support/random.h"
#include "tests/support/remeshed.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

/// A way to put the parts of a row elsewhere.
struct Variant {
  std::string name;
  double scale = 1;
  std::function<PolygonMesh(const PolygonMesh&)> change;  ///< of each part
  bool is_shuffled = false;
  bool is_for_large = true;  ///< rows with many parts take it, too
  bool is_for_small = true;  ///< and so do others
};

std::vector<Variant> all_variants(bool is_short) {
  std::vector<Variant> all;
  const auto same = [](const PolygonMesh& part) { return part; };
  all.push_back({"as it is", 1, same});
  Random random(base_seed(20));
  for (int i = 0; i < (is_short ? 2 : 20); ++i) {
    const Vec3 axis{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    const double degrees = random.uniform(0, 360);
    all.push_back({"turned " + std::to_string(i), 1,
                   [=](const PolygonMesh& part) { return shapes::rotated(part, axis, degrees); }, false, i < 2});
  }
  for (const double factor : {1e-6, 1e6})
    all.push_back({"scaled by " + std::to_string(factor), factor,
                   [=](const PolygonMesh& part) { return shapes::scaled(part, factor); }});
  all.push_back({"moved by a million", 1, [](const PolygonMesh& part) {
                   return shapes::moved(part, {1e6, 1e6, 1e6});
                 }});
  all.push_back({"shuffled", 1, same, true});
  all.push_back({"divided", 1,
                 [](const PolygonMesh& part) {
                   constexpr int kEach = 10;
                   return divided(shapes::fan_triangulated(part), kEach);
                 },
                 false, false});
  all.push_back({"divided a little", 1,
                 [](const PolygonMesh& part) { return divided(shapes::fan_triangulated(part), 2); }, false, true,
                 false});
  return all;
}

std::vector<double> volumes_of_cells(const TriangleMesh& mesh) {
  RunControl control;
  const std::vector<Vec3> scaled = scaled_for_predicates(mesh.positions.items(), control);
  const std::vector<std::int32_t> weights(mesh.faces.size(), 0);
  const Cells cells = find_cells({scaled, mesh.faces.items(), weights}, control);
  std::vector<long double> sums(cells.winding.size(), 0);
  const Vec3 origin = mesh.positions[mesh.faces[FaceId(0)][0]];
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) {
    const Triangle& t = mesh.faces[FaceId(f)];
    const Vec3 a = mesh.positions[t[0]] - origin, b = mesh.positions[t[1]] - origin, c = mesh.positions[t[2]] - origin;
    const double under = dot(a, cross(b - a, c - a)) / 6;
    sums[cells.of_side[2 * f]] -= under;
    sums[cells.of_side[2 * f + 1]] += under;
  }
  std::vector<double> volumes(sums.begin(), sums.end());
  std::erase_if(volumes, [](double v) { return v <= 0; });
  std::sort(volumes.begin(), volumes.end());
  return volumes;
}

/// Judges runs, and collects what is wrong.
class Judge {
 public:
  explicit Judge(std::size_t largest_for_cgal) : largest_for_cgal_(largest_for_cgal) {}

  void run(const SolidRow& row, const Variant& variant) {
    std::vector<PolygonMesh> parts;
    for (const PolygonMesh& part : row.parts) parts.push_back(variant.change(part));
    PolygonMesh mesh = as_one(parts);
    constexpr unsigned kSeed = 5;
    if (variant.is_shuffled) mesh = shapes::renumbered(mesh, kSeed);
    for (const bool is_union : {false, true}) {
      faults_.clear();
      const auto start = std::chrono::steady_clock::now();
      Options options = unrefined();
      options.repair.self_intersections = true;
      options.repair.make_union = is_union;
      std::size_t faces = 0;
      try {
        const Result result = remeshed(mesh, options);
        faces = result.mesh.faces.size();
        if (is_union)
          judge_union(row, variant, result);
        else
          judge_arrangement(row, variant, result);
        for (const Diagnostic& told : result.report.diagnostics)
          if (told.code == DiagnosticCode::kCutIntersections || told.code == DiagnosticCode::kDroppedPieces)
            expect(told.count > 0, told.message);
      } catch (const Error& error) {
        faults_.push_back(error.what());
      }
      const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      ++runs_;
      if (!faults_.empty()) ++failures_;
      constexpr double kSlow = 20;
      if (faults_.empty() && seconds < kSlow) continue;
      std::printf("row %d, %s, %s, %s: %zu faces in, %zu out, %.1f s", row.number, row.name.c_str(),
                  variant.name.c_str(), is_union ? "union" : "self_intersections", mesh.face_count(), faces, seconds);
      for (const std::string& fault : faults_) std::printf("; %s", fault.c_str());
      std::printf("\n");
      std::fflush(stdout);
    }
  }

  std::size_t runs() const { return runs_; }
  std::size_t failures() const { return failures_; }

 private:
  void expect(bool is_right, const std::string& fault) {
    if (!is_right) faults_.push_back(fault);
  }
  void expect_equal(double found, double known, double within, const char* what) {
    char text[128];
    std::snprintf(text, sizeof text, "%s %.17g instead of %.17g, off by %.2g of %.2g", what, found, known,
                  std::fabs(found - known), within);
    expect(std::fabs(found - known) <= within, text);
  }

  static double moved(const Result& result) { return result.report.solids ? result.report.solids->moved : 0; }
  /// How far points may be from where they belong.
  static double slack(const Measures& measures, const Result& result) {
    constexpr double kPlaces = 8;
    return kPlaces * std::ldexp(1.0, std::ilogb(measures.largest) - 52) + moved(result);
  }

  void judge_arrangement(const SolidRow& row, const Variant& variant, const Result& result) {
    expect_no_pair(result);
    const Measures measures = measures_of(result.mesh);
    const double cubed = variant.scale * variant.scale * variant.scale;
    const std::vector<double> cells = volumes_of_cells(result.mesh);
    expect(cells.size() == row.cells.size(),
           std::to_string(cells.size()) + " cells instead of " + std::to_string(row.cells.size()));
    for (std::size_t i = 0; i < cells.size() && cells.size() == row.cells.size(); ++i)
      if (const double off = std::fabs(cells[i] - cubed * row.cells[i]);
          !(off <= measures.area * slack(measures, result))) {
        expect_equal(cells[i], cubed * row.cells[i], measures.area * slack(measures, result), "a cell has");
        break;
      }
  }

  void judge_union(const SolidRow& row, const Variant& variant, const Result& result) {
    expect_no_pair(result);
    const Measures measures = measures_of(result.mesh);
    const double squared = variant.scale * variant.scale, within = slack(measures, result);
    expect_equal(measures.volume, squared * variant.scale * row.volume, measures.area * within, "volume");
    expect_equal(measures.area, squared * row.area, measures.lengths * within, "area");
    expect_equal(measures.euler, row.euler, 0, "Euler number");
    expect_equal(static_cast<double>(measures.shells), static_cast<double>(row.shells), 0, "shells");
    expect_equal(static_cast<double>(measures.four_faces), static_cast<double>(row.four_faces), 0,
                 "edges with four faces");
    expect_equal(static_cast<double>(measures.other_edges), 0, 0, "edges with other numbers of faces");
    if (row.triangles > 0)
      expect_equal(static_cast<double>(result.mesh.faces.size()), static_cast<double>(row.triangles), 0, "triangles");
    expect(result.report.volume_obstacles.empty(), "it is not ready for a volume mesh");
  }

  void expect_no_pair(const Result& result) {
    RunControl control;
    expect(self_intersections(result.mesh.positions.items(), result.mesh.faces.items(), {}, SearchLimits(1000), control)
               .pairs.empty(),
           "faces intersect");
    if (result.mesh.faces.size() <= largest_for_cgal_)
      expect(pairs_by_cgal(result.mesh, 1) == 0, "faces intersect by CGAL");
  }

  const std::size_t largest_for_cgal_;
  std::vector<std::string> faults_;
  std::size_t runs_ = 0, failures_ = 0;
};

/// Prints how many pairs of triangles of a mesh intersect by our test and by that of CGAL.
int print_pairs(const std::string& path) {
  RunControl control;
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const PolygonMesh mesh = read_mesh(Format::kObj, text, {}, control).mesh;
  TriangleMesh triangles;
  triangles.positions = mesh.positions;
  for (FaceId f(0); f.value < mesh.face_count(); ++f.value)
    triangles.faces.push_back({mesh.face(f)[0], mesh.face(f)[1], mesh.face(f)[2]});
  constexpr std::size_t kMany = 1000;
  const SelfIntersections ours =
      self_intersections(triangles.positions.items(), triangles.faces.items(), {}, SearchLimits(kMany), control);
  std::printf("%zu %zu\n", ours.pairs.size(), pairs_by_cgal(triangles, kMany));
  return 0;
}

/// Writes the parts of each row to an OBJ file in a folder, and prints the file's name and the number of cells.
int write_rows(const std::string& folder) {
  std::map<int, int> with_number;
  for (const SolidRow& row : solid_rows()) {
    const int before = with_number[row.number]++;
    const std::string name =
        "row_" + std::to_string(row.number) + (before > 0 ? "_" + std::to_string(before + 1) : "") + ".obj";
    std::ofstream file(folder + "/" + name);
    file.precision(std::numeric_limits<double>::max_digits10);
    const PolygonMesh mesh = as_one(row.parts);
    for (const Vec3& p : mesh.positions) file << "v " << p.x << ' ' << p.y << ' ' << p.z << '\n';
    for (FaceId f(0); f.value < mesh.face_count(); ++f.value) {
      file << 'f';
      for (const VertexId v : mesh.face(f)) file << ' ' << v.value + 1;
      file << '\n';
    }
    std::printf("%s %zu\n", name.c_str(), row.cells.size());
  }
  return 0;
}

int run(int argc, char** argv) {
  if (argc == 3 && std::string_view(argv[1]) == "--pairs-of") return print_pairs(argv[2]);
  if (argc == 3 && std::string_view(argv[1]) == "--write") return write_rows(argv[2]);
  bool is_short = false;
  std::set<int> only;
  std::string_view way;
  for (int i = 1; i < argc; ++i) {
    if (std::string_view(argv[i]) == "--short")
      is_short = true;
    else if (std::string_view(argv[i]) == "--way" && i + 1 < argc)
      way = argv[++i];
    else
      only.insert(std::atoi(argv[i]));
  }
  constexpr std::size_t kLargestForCgal = 2000, kLargestOfShort = 400;
  Judge judge(is_short ? kLargestOfShort : kLargestForCgal);
  const std::vector<Variant> variants = all_variants(is_short);
  for (const SolidRow& row : solid_rows()) {
    if (!only.empty() && !only.contains(row.number)) continue;
    if (is_short && row.is_large) continue;
    const std::size_t before = judge.failures(), runs = judge.runs();
    const auto start = std::chrono::steady_clock::now();
    for (const Variant& variant : variants) {
      if (variant.name.find(way) == std::string::npos) continue;
      if (row.is_large ? variant.is_for_large : variant.is_for_small) judge.run(row, variant);
    }
    std::printf("row %d, %s: %zu of %zu runs failed, %.1f s\n", row.number, row.name.c_str(), judge.failures() - before,
                judge.runs() - runs, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    std::fflush(stdout);
  }
  std::printf("%zu of %zu runs failed\n", judge.failures(), judge.runs());
  return judge.failures() == 0 ? 0 : 1;
}

}  // namespace
}  // namespace remesh

int main(int argc, char** argv) { return remesh::run(argc, argv); }
