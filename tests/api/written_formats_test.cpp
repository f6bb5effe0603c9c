// Tests that the program writes what it promises. Results in every format are read back by readers that are not ours.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <sstream>
#include <string>

#include "api/job.h"
#include "api/operations.h"
#include "core/io/obj/obj.h"
#include "core/io/stl/stl.h"
#include "core/output/result/round_for_format.h"
#include "tests/support/cgal_space.h"
#include "tests/support/errors.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"
#include "tests/support/shared_meshes.h"
#include "tests/support/written_mesh.h"

namespace remesh::api {
namespace {

using testing::HasSubstr;
using testing::Not;
using Corners = std::array<Vec3, 3>;

Job job_of(std::string_view mesh, const Fields& options) {
  Job job;
  job.mesh = mesh;
  for (const auto& [name, value] : options) job.options.add(name, value);
  return job;
}

bool has_floats(Format format) { return storage_of(format) == Storage::kFloat; }

Fields with(Fields options, const std::string& name, const std::string& value) {
  options.emplace_back(name, value);
  return options;
}

/// The result in doubles that is meant for a format.
Result in_doubles(std::string_view mesh, const Fields& options, Format format) {
  RunControl control;
  const Fields with_format = with(options, "format", std::string(format_name(format)));
  return remesh_for_job(job_of(mesh, with_format), {}, Purpose::kKeeping, control).result;
}

RemeshAnswer written(std::string_view mesh, const Fields& options, Format format) {
  RunControl control;
  return run_remesh_job(job_of(mesh, with(options, "format", std::string(format_name(format)))), {}, control);
}

/// A mesh that was read back. It has the corners of each triangle, in the order of the file.
struct ReadMesh {
  std::vector<Corners> triangles;
  std::vector<std::string> solid_of;  ///< the name of each triangle's solid, for text STL
};

ReadMesh read(Format format, const std::string& file) {
  const test::WrittenMesh mesh = test::read_written(format, file);
  ReadMesh back{{}, mesh.solid_of};
  for (const auto& [a, b, c] : mesh.faces)
    back.triangles.push_back({mesh.positions[a], mesh.positions[b], mesh.positions[c]});
  if (format != Format::kStlAscii) return back;
  std::istringstream words(file);
  for (std::string word, x, y, z; words >> word;)
    if (word == "normal" && words >> x >> y >> z) {
      EXPECT_NEAR(
          norm(Vec3{std::strtod(x.c_str(), nullptr), std::strtod(y.c_str(), nullptr), std::strtod(z.c_str(), nullptr)}),
          1, 1e-6);
    }
  return back;
}

Corners corners_of(const TriangleMesh& mesh, std::uint32_t f) {
  const auto& [a, b, c] = mesh.faces[FaceId(f)];
  return {mesh.positions[a], mesh.positions[b], mesh.positions[c]};
}

/// A soup of triangles as a mesh: corners with equal coordinates are one vertex.
struct Joined {
  std::vector<Vec3> points;
  std::vector<Triangle> faces;

  explicit Joined(const std::vector<Corners>& triangles) {
    std::map<Vec3, std::uint32_t> known;
    for (const Corners& corners : triangles) {
      Triangle face;
      for (int i = 0; i < 3; ++i) {
        const auto [at, is_new] = known.try_emplace(corners[i], static_cast<std::uint32_t>(points.size()));
        if (is_new) points.push_back(corners[i]);
        face[i] = VertexId(at->second);
      }
      faces.push_back(face);
    }
  }

  /// Returns the number of pairs of faces that intersect, as CGAL finds them.
  std::size_t intersections() const {
    const CgalIntersection do_intersect(points);
    std::vector<Box3> boxes(faces.size());
    for (std::size_t f = 0; f < faces.size(); ++f)
      for (const VertexId v : faces[f]) boxes[f].add(points[v.value]);
    std::size_t count = 0;
    for (std::size_t f = 0; f < faces.size(); ++f)
      for (std::size_t g = 0; g < f; ++g) {
        bool are_apart = false;
        for (int axis = 0; axis < 3; ++axis)
          are_apart = are_apart || boxes[f].max[axis] < boxes[g].min[axis] || boxes[g].max[axis] < boxes[f].min[axis];
        if (!are_apart && do_intersect(faces[f], faces[g])) ++count;
      }
    return count;
  }
  bool is_any_flat() const {
    const CgalIntersection do_intersect(points);
    return std::any_of(faces.begin(), faces.end(), [&](const Triangle& t) { return !do_intersect.has_area(t); });
  }
  /// Returns the smallest of all edges, heights, and gaps between faces that share no vertex.
  double smallest_feature() const {
    double smallest = HUGE_VAL;
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const auto& [a, b, c] = faces[f];
      const Vec3 &p = points[a.value], &q = points[b.value], &r = points[c.value];
      const double longest = std::max({norm(q - p), norm(r - q), norm(p - r)});
      smallest = std::min({smallest, norm(q - p), norm(r - q), norm(p - r), norm(cross(q - p, r - p)) / longest});
      for (std::size_t g = 0; g < f; ++g) {
        const bool is_shared = std::any_of(faces[f].begin(), faces[f].end(), [&](VertexId v) {
          return std::find(faces[g].begin(), faces[g].end(), v) != faces[g].end();
        });
        if (is_shared) continue;
        const auto corners = [&](std::size_t i) {
          return Corners3{points[faces[i][0].value], points[faces[i][1].value], points[faces[i][2].value]};
        };
        smallest = std::min(smallest, std::sqrt(cgal_squared_distance(corners(f), corners(g))));
      }
    }
    return smallest;
  }
};

double half_step_of_floats(const std::vector<Vec3>& points) {
  double largest = 0;
  for (const Vec3& p : points) largest = std::max({largest, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
  const auto nearest = static_cast<float>(largest);
  return (static_cast<double>(std::nextafter(nearest, HUGE_VALF)) - nearest) / 2;
}

std::vector<Corners> soup_of(const TriangleMesh& mesh) {
  std::vector<Corners> soup;
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) soup.push_back(corners_of(mesh, f));
  return soup;
}

/// Compares what was written with the result in doubles, triangle by triangle.
void expect_as_promised(const Result& exact, const RemeshAnswer& answer) {
  const ReadMesh back = read(answer.format, answer.body);
  ASSERT_EQ(back.triangles.size(), exact.mesh.faces.size());
  const Vec3 origin = answer.report.output_origin.value_or(Vec3{});
  double farthest = 0;
  for (std::uint32_t f = 0; f < back.triangles.size(); ++f) {
    const Corners wanted = corners_of(exact.mesh, f);
    for (int i = 0; i < 3; ++i) farthest = std::max(farthest, norm(origin + back.triangles[f][i] - wanted[i]));
  }
  EXPECT_DOUBLE_EQ(farthest, answer.report.output_rounding);
  EXPECT_GE(answer.report.verified.deviation, farthest);
  if (!has_floats(answer.format)) {
    EXPECT_EQ(farthest, 0);
    EXPECT_FALSE(answer.report.output_origin);
    return;
  }
  EXPECT_LE(farthest, std::max(exact.report.plane_tolerance, 1e-6 * exact.report.input.bounding_box.diagonal()));
  const Joined mesh(back.triangles);
  EXPECT_EQ(mesh.points.size(), exact.mesh.positions.size());
  EXPECT_FALSE(mesh.is_any_flat());
  EXPECT_EQ(mesh.intersections(), 0u);
}

/// Returns a closed or open shape without intersections as OBJ. It is turned, and moved by up to 1e7 of its size.
std::string random_obj(Random& random) {
  const auto shape = [&]() -> PolygonMesh {
    switch (random.below(7)) {
      case 0: return shapes::box({1, random.uniform(1e-4, 1), random.uniform(1e-6, 1)});
      case 1: return shapes::l_bracket(1);
      case 2: return shapes::plate_with_round_hole(8);
      case 3: return shapes::cylinder(random.integer(3, 20), 0.5, random.uniform(1e-4, 2));
      case 4: return shapes::sphere(1);
      case 5: return shapes::slotted_plate(1);
      default: return shapes::noisy_sheet(3, static_cast<unsigned>(random.below(1000)));
    }
  };
  const double size = std::pow(10, random.uniform(-6, 6));
  const double offset = random.chance(0.2) ? 0 : size * std::pow(10, random.uniform(-1, 7));
  PolygonMesh mesh = shapes::scaled(shape(), size);
  if (random.chance(0.8))
    mesh = shapes::rotated(mesh, {random.uniform(-1, 1), random.uniform(-1, 1), 1}, random.uniform(0, 180));
  mesh = shapes::moved(mesh, offset * Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
  RunControl control;
  return write_obj(shapes::as_triangles(shapes::fan_triangulated(mesh)), {}, control);
}

TEST(written_formats, whatever_is_written_is_read_back_as_promised_or_was_refused_with_reason) {
  Random random(base_seed(360202));
  int written_stl = 0, refused = 0, about_origin = 0;
  for (int trial = 0; trial < 120; ++trial) {
    SCOPED_TRACE(trial);
    const std::string mesh = random_obj(random);
    Fields options{{"refine", random.chance(0.6) ? "true" : "false"}, {"min_angle_deg", "20"}};
    if (random.chance(0.5)) options.emplace_back("local_origin", "true");
    const Result for_doubles = in_doubles(mesh, options, Format::kObj);
    const Result for_floats = in_doubles(mesh, options, Format::kStl);
    ASSERT_LT(for_doubles.mesh.faces.size(), 3000u);
    for (const Format format : kFormats) {
      if (!is_written(format)) continue;
      SCOPED_TRACE(format_name(format));
      const Result& exact = has_floats(format) ? for_floats : for_doubles;
      try {
        const RemeshAnswer answer = written(mesh, options, format);
        expect_as_promised(exact, answer);
        if (has_floats(format)) ++(answer.report.output_origin ? about_origin : written_stl);
      } catch (const Error& error) {
        ASSERT_TRUE(has_floats(format)) << error.what();
        ASSERT_EQ(error.code, Code::kNotAcceptable) << error.what();
        ++refused;
        const double half_step = half_step_of_floats(exact.mesh.positions.items());
        if (half_step >= 1e-7 * exact.report.input.bounding_box.diagonal()) continue;
        // Steps as fine as these are no reason to refuse, unless a feature of the mesh is as small.
        EXPECT_LT(Joined(soup_of(exact.mesh)).smallest_feature(), 20 * half_step) << error.what();
      }
    }
  }
  // The test says something only if all three cases occur.
  EXPECT_GT(written_stl, 20);
  EXPECT_GT(refused, 20);
  EXPECT_GT(about_origin, 10);
}

TEST(written_formats, a_kept_job_gives_each_format_as_it_would_have_been_at_once_refusals_too) {
  Random random(base_seed(360203));
  for (int trial = 0; trial < 12; ++trial) {
    SCOPED_TRACE(trial);
    const std::string mesh = random_obj(random);
    const Fields options{{"max_edge_fraction", "0.4"}, {"local_origin", random.chance(0.5) ? "true" : "false"}};
    Request request;
    request.body = mesh;
    request.query = options;
    RunControl control;
    Request as_stl = request;
    as_stl.query = with(options, "format", "stl");
    const StoredRemesh for_doubles = run_remesh_to_keep(request, {}, control);
    const StoredRemesh for_floats = run_remesh_to_keep(as_stl, {}, control);
    for (const Format format : kFormats) {
      if (!is_written(format)) continue;
      SCOPED_TRACE(format_name(format));
      const StoredRemesh& kept = has_floats(format) ? for_floats : for_doubles;
      Request at_once = request, later;
      at_once.query = with(options, "format", std::string(format_name(format)));
      later.query = {{"format", std::string(format_name(format))}};
      std::optional<Response> direct;
      std::string refusal;
      try {
        direct = run_remesh(at_once, {}, control);
      } catch (const Error& error) {
        refusal = error.what();
      }
      const auto write = [&] {
        return write_kept(
            kept.mesh, [&] { return kept.report; }, later, control);
      };
      if (!direct) {
        EXPECT_EQ(test::error_of(write).what(), refusal);
        // The job has its result all the same, for every other format.
        later.query = {{"format", "obj"}};
        EXPECT_EQ(write().status, 200);
        continue;
      }
      const Response fetched = write();
      EXPECT_EQ(fetched.headers[0], direct->headers[0]) << "Remesh-Summary";
      if (format != Format::kJson) {
        EXPECT_TRUE(fetched.body == direct->body);
      }
    }
  }
}

std::string contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

class shared_meshes : public testing::Test {
 protected:
  void SetUp() override { test::has_shared_mesh(); }
  const std::filesystem::path folder_ = test::shared_meshes_folder();
};

TEST_F(shared_meshes, a_house_at_map_coordinates_is_exact_in_doubles_and_refused_in_floats) {
  // This is pinned from a run in doubles and may change with the algorithm. In floats there were 70 patches.
  constexpr std::size_t kPinnedPatches = 32;
  if (!test::has_shared_mesh("reports/house-utm.obj.gz")) return;
  const std::string house = contents(folder_ / "reports" / "house-utm.obj.gz");
  for (const Fields& options : {Fields{{"refine", "false"}}, Fields{}}) {
    const Result exact = in_doubles(house, options, Format::kObj);
    for (const Format format : kFormats)
      if (is_written(format) && !has_floats(format)) expect_as_promised(exact, written(house, options, format));
    const Error error = test::error_of([&] { written(house, options, Format::kStl); });
    EXPECT_EQ(error.code, Code::kNotAcceptable);
    EXPECT_THAT(error.what(), HasSubstr("0.5 apart"));
    EXPECT_THAT(error.what(), HasSubstr("obj, json, stl_ascii, ply, off, vtu, msh, mesh, smesh, ply_ascii"));
    EXPECT_THAT(error.what(), HasSubstr("local_origin=true"));
    const RemeshAnswer local = written(house, with(options, "local_origin", "true"), Format::kStl);
    expect_as_promised(in_doubles(house, with(options, "local_origin", "true"), Format::kStl), local);
    ASSERT_TRUE(local.report.output_origin);
    EXPECT_NEAR(*local.report.output.volume, *exact.report.output.volume, local.report.volume_bound);
    EXPECT_EQ(local.report.patches.size(), kPinnedPatches);
    EXPECT_THAT(summary_line(summary_of(local.report)),
                HasSubstr("origin=" + origin_text(*local.report.output_origin)));
    EXPECT_THAT(local.body.substr(0, 80), HasSubstr("origin " + origin_text(*local.report.output_origin)));
  }
}

/// Makes a box of 10 x 13 x 3 at map coordinates, where floats are 0.5 apart.
std::string box_on_a_map() {
  std::string text;
  for (const char* z : {"312", "315"})
    for (const char* xy : {"453008.3 5412345.3", "453018.3 5412345.3", "453018.3 5412358.3", "453008.3 5412358.3"})
      text += std::string("v ") + xy + " " + z + "\n";
  return text + "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
}

TEST(written_formats, a_face_that_is_gone_allows_no_larger_rounding) {
  // Its corner makes the input's bounding box a thousand times as large.
  for (const std::string more : {"", "v 0 0 0\n", "v 0 0 0\nf 9 9 1\n"}) {
    const Error error = test::error_of([&] { written(box_on_a_map() + more, {{"refine", "false"}}, Format::kStl); });
    EXPECT_EQ(error.code, Code::kNotAcceptable) << more;
  }
}

/// A part in floats as binary STL. It is turned, and lies `offset` times its size from the origin.
std::string stl_upload(const PolygonMesh& part, double angle, double offset) {
  PolygonMesh placed = shapes::moved(shapes::rotated(part, {1, 2, 3}, angle), offset * Vec3{0.7, -0.6, 0.4});
  for (Vec3& p : placed.positions)
    for (int axis = 0; axis < 3; ++axis) p[axis] = static_cast<float>(p[axis]);
  RunControl control;
  return write_stl(shapes::as_triangles(shapes::fan_triangulated(placed)), {}, control);
}

TEST(written_formats, an_upload_as_stl_comes_back_as_stl_or_as_text_however_far_from_the_origin_it_lies) {
  const std::vector<PolygonMesh> parts{shapes::l_bracket(1), shapes::cylinder(7, 0.5, 2),
                                       shapes::plate_with_round_hole(8), shapes::box({1, 1e-3, 1})};
  int binary = 0, text = 0;
  for (const double offset : {1.0, 1e4, 1e5, 1e6, 3e6})
    for (const PolygonMesh& part : parts) {
      SCOPED_TRACE(offset);
      const std::string upload = stl_upload(part, 40, offset);
      Request request;
      request.body = upload;
      RunControl control;
      try {
        const Response answer = run_remesh(request, {}, control);
        EXPECT_EQ(answer.status, 200);
        const bool is_text = answer.content_type == "model/stl; charset=utf-8";
        EXPECT_EQ(answer.body.starts_with("solid"), is_text);
        ++(is_text ? text : binary);
        const Format format = is_text ? Format::kStlAscii : Format::kStl;
        EXPECT_FALSE(Joined(read(format, answer.body).triangles).is_any_flat());
      } catch (const Error& error) {
        // Coordinates may have collapsed in the upload already.
        EXPECT_TRUE(error.code == Code::kInvalidMesh || error.code == Code::kEmptyMesh) << error.what();
      }
    }
  EXPECT_GT(binary, 8);
  EXPECT_GT(text, 0);
}

TEST(written_formats, a_result_that_binary_stl_cannot_hold_is_text_refused_by_name_and_kept_by_a_job) {
  // Doubles of a box at map coordinates, and an answer in floats. An upload in OBJ shows it best, since its own
  // coordinates are no floats; one in STL does where new vertices are no floats.
  const std::string box = box_on_a_map();
  RunControl control;
  Job open = job_of(box, {});
  open.input_format = Format::kObj;
  open.accept = "model/stl, */*;q=0.5";
  EXPECT_EQ(test::error_of([&] { run_remesh_job(std::move(open), {}, control); }).code, Code::kNotAcceptable);
  Request by_name;
  by_name.body = box;
  by_name.query = {{"format", "stl"}};
  EXPECT_EQ(test::error_of([&] { run_remesh(by_name, {}, control); }).code, Code::kNotAcceptable);
  const StoredRemesh kept = run_remesh_to_keep(by_name, {}, control);
  const auto fetched = [&](const Fields& query) {
    Request later;
    later.query = query;
    return write_kept(
        kept.mesh, [&] { return kept.report; }, later, control);
  };
  EXPECT_EQ(test::error_of([&] { fetched({}); }).code, Code::kNotAcceptable);
  for (const char* format : {"obj", "ply", "stl_ascii", "json"}) EXPECT_EQ(fetched({{"format", format}}).status, 200);
  EXPECT_EQ(fetched({{"local_origin", "true"}}).content_type, "model/stl");
}

TEST(written_formats, the_header_of_binary_stl_has_a_whole_origin_or_none) {
  for (const double size : {1.0, 1e-3, 1e-5, 1e-7}) {
    std::string text;
    for (const int corner : {0, 1, 2, 3}) {
      const Vec3 at = Vec3{-512345678.123452, -412345678.765427, -612345678.123451} +
                      size * Vec3{corner == 1 ? 1.0 : 0, corner == 2 ? 1.0 : 0, corner == 3 ? 1.0 : 0};
      text += "v " + origin_text(at) + "\n";
    }
    text += "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    try {
      const RemeshAnswer answer = written(text, {{"refine", "false"}, {"local_origin", "true"}}, Format::kStl);
      const std::string header = answer.body.substr(0, 80);
      ASSERT_TRUE(answer.report.output_origin);
      const std::string origin = "origin " + origin_text(*answer.report.output_origin);
      const std::size_t found = header.find("origin");
      if (found != std::string::npos) {
        EXPECT_EQ(header.substr(found, origin.size()), origin);
        EXPECT_THAT(header.substr(found + origin.size(), 1), testing::AnyOf("", " ", ","));
      }
      EXPECT_THAT(header, testing::StartsWith("binary STL"));
    } catch (const Error& error) {
      EXPECT_EQ(error.code, Code::kNotAcceptable) << error.what();
    }
  }
}

std::uint64_t count_unrefined(const Report& report) {
  std::uint64_t count = 0;
  for (const Unrefined& left : report.unrefined) count += left.count;
  return count;
}

TEST(written_formats, binary_stl_lists_all_faces_that_doubles_list) {
  // A thin plate whose rim stays: its edges are as long as allowed, and far longer than the gap asks for.
  std::string text;
  for (const int z : {0, 1})
    for (int i = 0; i < 40; ++i) {
      const int side = i / 10;
      const double along = 0.1 * (i % 10);
      const double x = side == 0 ? along : side == 1 ? 1 : side == 2 ? 1 - along : 0;
      const double y = side == 0 ? 0 : side == 1 ? along : side == 2 ? 1 : 1 - along;
      text += "v " + origin_text({x, y, 0.02 * z}) + "\n";
    }
  std::string top = "f", bottom = "f";
  for (int i = 1; i <= 40; ++i) {
    const int next = i % 40 + 1;
    top += " " + std::to_string(40 + i);
    bottom += " " + std::to_string(41 - i);
    text += "f " + std::to_string(i) + " " + std::to_string(next) + " " + std::to_string(40 + next) + " " +
            std::to_string(40 + i) + "\n";
  }
  text += top + "\n" + bottom + "\n";
  const Fields options{{"proximity", "1"},
                       {"split_boundaries", "false"},
                       {"keep_boundary_vertices", "true"},
                       {"max_edge_length", "0.1"}};
  const std::uint64_t listed = count_unrefined(written(text, options, Format::kObj).report);
  EXPECT_GT(listed, 100u);
  EXPECT_GE(count_unrefined(written(text, options, Format::kStl).report), listed);
}

TEST(written_formats, ten_edges_to_a_side_are_no_fault_of_binary_stl) {
  const std::string cube =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
      "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
  EXPECT_EQ(count_unrefined(written(cube, {{"max_edge_length", "0.1"}}, Format::kStl).report), 0u);
}

TEST_F(shared_meshes, ordinary_parts_come_out_as_binary_stl) {
  for (const char* name :
       {"curved-cad/sv_cylinder.stl", "curved-cad/tube.obj", "curved-cad/hx_shell_to_solid.stl.gz"}) {
    if (!test::has_shared_mesh(name)) continue;
    const std::string mesh = contents(folder_ / name);
    ASSERT_FALSE(mesh.empty()) << name;
    for (const Fields& options : {Fields{{"refine", "false"}}, Fields{}}) {
      const RemeshAnswer answer = written(mesh, options, Format::kStl);
      EXPECT_FALSE(answer.report.output_origin) << name;
      EXPECT_EQ(answer.report.output.intersecting_pairs, 0u) << name;
      const ReadMesh back = read(Format::kStl, answer.body);
      EXPECT_EQ(back.triangles.size(), answer.report.output.faces) << name;
      EXPECT_EQ(Joined(back.triangles).points.size(), answer.report.output.vertices) << name;
    }
  }
}

TEST(written_formats, text_stl_has_a_solid_for_each_group_and_is_read_by_our_reader) {
  const std::string mesh =
      "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 0 1 0\nv 0 0.1 -1.5e-300\ng inlet 1\nf 1 2 5 6\n"
      "g outlet\nf 2 3 4 5\ng inlet 1\nf 6 5 7\n";
  const RemeshAnswer answer = written(mesh, {{"refine", "false"}}, Format::kStlAscii);
  EXPECT_THAT(answer.body, testing::StartsWith("solid inlet_1\n"));
  const ReadMesh back = read(Format::kStlAscii, answer.body);
  EXPECT_TRUE(std::is_sorted(back.solid_of.begin(), back.solid_of.end()));
  EXPECT_EQ(std::count(back.solid_of.begin(), back.solid_of.end(), "outlet"), 2);
  // The digits are those of the doubles.
  EXPECT_THAT(answer.body, HasSubstr("vertex 0 0.1 -1.5e-300\n"));
  const RemeshAnswer again = written(answer.body, {{"refine", "false"}}, Format::kObj);
  EXPECT_EQ(again.report.output.faces, answer.report.output.faces);
  EXPECT_EQ(again.report.output.area, answer.report.output.area);
  EXPECT_THAT(again.body, HasSubstr("o inlet_1\n"));
}

TEST(written_formats, the_report_tells_the_names_that_the_format_has_changed_and_jobs_tell_them_likewise) {
  const std::string mesh =
      "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 0 1 0\ng inlet 1\nf 1 2 5 6\ng outlet\nf 2 3 4 5\n";
  const std::vector<RenamedLabel> one{{"inlet 1", "inlet_1"}}, none;
  const auto told = [&](Fields options, Format format) {
    const RemeshAnswer answer = written(mesh, options, format);
    const std::size_t diagnostics = static_cast<std::size_t>(
        std::count_if(answer.report.diagnostics.begin(), answer.report.diagnostics.end(),
                      [](const Diagnostic& d) { return d.code == DiagnosticCode::kRenamedLabels; }));
    EXPECT_EQ(diagnostics, answer.report.renamed_labels.empty() ? 0u : 1u);
    return answer.report.renamed_labels;
  };
  for (const Format format : {Format::kStlAscii, Format::kMsh, Format::kMesh, Format::kSmesh}) {
    EXPECT_EQ(told({}, format), one);
    EXPECT_EQ(told({{"names", "exact"}}, format), none);
    EXPECT_EQ(told({{"label", "patch"}}, format), none);
  }
  EXPECT_EQ(told({{"stl_solids", "one"}}, Format::kStlAscii), none);
  for (const Format format : {Format::kObj, Format::kPly, Format::kVtu, Format::kJson})
    EXPECT_EQ(told({}, format), none);

  RunControl control;
  Request request;
  request.body = mesh;
  request.query = {{"format", "msh"}};
  const StoredRemesh kept = run_remesh_to_keep(request, {}, control);
  EXPECT_THAT(kept.report, HasSubstr(R"("renamed_labels":[{"from":"inlet 1","to":"inlet_1"}])"));
  const auto fetched = [&](Fields query) {
    Request wanted;
    wanted.query = std::move(query);
    return write_kept(
        kept.mesh, [&] { return kept.report; }, wanted, control);
  };
  EXPECT_EQ(fetched({}).body, written(mesh, {}, Format::kMsh).body);
  EXPECT_THAT(fetched({{"format", "json"}}).body, HasSubstr(R"("renamed_labels":[])"));
  EXPECT_THAT(fetched({{"names", "exact"}}).body, HasSubstr("\"inlet 1\""));
  EXPECT_EQ(fetched({{"format", "stl_ascii"}, {"label", "patch"}}).body,
            written(mesh, {{"label", "patch"}}, Format::kStlAscii).body);
}

TEST(written_formats, both_versions_of_gmshs_format_have_the_same_faces_under_the_same_numbers) {
  const std::string mesh = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 0 1 0\ng b\nf 1 2 5 6\ng a\nf 2 3 4 5\n";
  const Fields options{{"max_edge_length", "0.4"}, {"barriers", "none"}};
  const ReadMesh old_version = read(Format::kMsh, written(mesh, options, Format::kMsh).body);
  const ReadMesh new_version =
      read(Format::kMsh, written(mesh, with(options, "msh_version", "4.1"), Format::kMsh).body);
  EXPECT_GT(old_version.triangles.size(), 20u);
  EXPECT_EQ(old_version.triangles, new_version.triangles);
}

TEST(written_formats, text_stl_without_labels_is_one_solid_without_a_name) {
  const std::string mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  const RemeshAnswer answer = written(mesh, {{"refine", "false"}}, Format::kStlAscii);
  EXPECT_THAT(answer.body, testing::StartsWith("solid \n"));
  EXPECT_THAT(written(answer.body, {{"refine", "false"}}, Format::kObj).body, Not(HasSubstr("\no")));
}

}  // namespace
}  // namespace remesh::api
