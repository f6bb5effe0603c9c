#include <cmath>
#include <limits>

#include "core/io/bytes.h"
#include "core/io/stl.h"
#include "core/io/write_text.h"

namespace remesh {
namespace {

constexpr std::size_t kHeader = 80;

float to_float(double coordinate) {
  const auto rounded = static_cast<float>(coordinate);
  if (std::isfinite(rounded)) return rounded;
  throw Error(Code::kNotAcceptable, Stage::kWrite,
              "a coordinate is beyond the largest float, the only numbers that STL has; ask for another format")
      .for_option("format");
}

/// Unit normal; zero, as is the custom, where there is none.
Vec3 normal_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  // Unit vectors first: their product neither overflows nor underflows.
  return normalized(cross(normalized(b - a), normalized(c - a)));
}

}  // namespace

std::string write_stl(const TriangleMesh& mesh, const std::vector<std::string>& comments, RunControl& control) {
  control.enter(Stage::kWrite);
  constexpr std::uint32_t kMaxCount = std::numeric_limits<std::uint32_t>::max();
  if (mesh.faces.size() > kMaxCount) {
    throw Error(Code::kOutputTooLarge, Stage::kWrite, "more triangles than STL counts").with_limit(kMaxCount);
  }
  // Readers take a header that begins with "solid" for text.
  std::string out = "binary STL, coordinates rounded to floats";
  if (!comments.empty()) out += "; " + without_control_characters(comments.front());
  out.resize(kHeader, ' ');
  out.reserve(kHeader + 4 + 50 * mesh.faces.size());
  append_little_endian(out, static_cast<std::uint32_t>(mesh.faces.size()));

  WriteProgress progress(mesh.faces.size(), control);
  for (const Triangle& face : mesh.faces) {
    progress.tick();
    const Vec3 corners[3] = {mesh.positions[face[0]], mesh.positions[face[1]], mesh.positions[face[2]]};
    const Vec3 normal = normal_of(corners[0], corners[1], corners[2]);
    for (const Vec3& v : {normal, corners[0], corners[1], corners[2]}) {
      for (int axis = 0; axis < 3; ++axis) append_little_endian(out, to_float(v[axis]));
    }
    append_little_endian(out, std::uint16_t{0});
  }
  return out;
}

}  // namespace remesh
